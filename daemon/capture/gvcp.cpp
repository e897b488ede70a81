// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/gvcp.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <utility>

namespace lightwell {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::byte kKey{0x42};
constexpr std::uint16_t kDiscoveryCommand = 0x0002, kDiscoveryAck = 0x0003;
constexpr std::uint16_t kReadRegisterCommand = 0x0080, kReadRegisterAck = 0x0081;
constexpr std::size_t kHeader = 8;
constexpr std::size_t kDiscoveryPayload = 248;

// A UDP socket of its own; closed with the object.
class Socket {
 public:
  Socket() : fd_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {}
  Socket(Socket&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Socket& operator=(Socket&&) = delete;
  ~Socket() {
    if (fd_ >= 0) ::close(fd_);
  }
  [[nodiscard]] int fd() const { return fd_; }

 private:
  int fd_;
};

void put16(std::byte* at, unsigned value) {
  at[0] = static_cast<std::byte>(value >> 8 & 0xff);
  at[1] = static_cast<std::byte>(value & 0xff);
}

unsigned get16(const std::byte* at) {
  return std::to_integer<unsigned>(at[0]) << 8 | std::to_integer<unsigned>(at[1]);
}

std::uint32_t get32(const std::byte* at) {
  return get16(at) << 16 | get16(at + 2);
}

std::string text(const std::byte* at, std::size_t size) {
  const char* begin = reinterpret_cast<const char*>(at);
  std::string out(begin, strnlen(begin, size));
  std::replace_if(
      out.begin(), out.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
  return out;
}

std::array<std::byte, kHeader> discovery_command(bool broadcast) {
  std::array<std::byte, kHeader> packet{};
  packet[0] = kKey;
  packet[1] =
      broadcast ? std::byte{0x11} : std::byte{0x01};  // acknowledge; broadcast acknowledgement allowed
  put16(&packet[2], kDiscoveryCommand);
  put16(&packet[6], 1);  // request id, any but 0
  return packet;
}

std::optional<sockaddr_in> endpoint(const std::string& address) {
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(kGvcpPort);
  if (::inet_pton(AF_INET, address.c_str(), &to.sin_addr) != 1) return std::nullopt;
  return to;
}

void send(const Socket& socket, std::span<const std::byte> packet, const sockaddr_in& to) {
  // A network that cannot be reached answers no question either: the timeout says it.
  static_cast<void>(::sendto(socket.fd(), packet.data(), packet.size(), 0,
                             reinterpret_cast<const sockaddr*>(&to), sizeof to));
}

// The next packet on any of the sockets, empty after the deadline.
std::span<const std::byte> receive(std::span<const Socket> sockets, Clock::time_point deadline,
                                   std::span<std::byte> buffer) {
  std::vector<pollfd> fds;
  for (const Socket& socket : sockets) fds.push_back({socket.fd(), POLLIN, 0});
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now());
    if (left.count() < 0 || ::poll(fds.data(), fds.size(), static_cast<int>(left.count())) <= 0) return {};
    for (const pollfd& fd : fds) {
      if (fd.revents == 0) continue;
      const auto size = ::recv(fd.fd, buffer.data(), buffer.size(), 0);
      if (size > 0) return buffer.first(static_cast<std::size_t>(size));
      if (fds.size() == 1) return {};  // refused: nobody listens there
    }
  }
}

bool is_ack(std::span<const std::byte> packet, std::uint16_t ack, std::size_t payload) {
  return packet.size() >= kHeader + payload && get16(packet.data()) == 0 && get16(&packet[2]) == ack;
}

// A question to one address, repeated as datagrams may be lost.
std::optional<std::vector<std::byte>> ask(const std::string& address, std::span<const std::byte> command,
                                          std::uint16_t ack, std::size_t payload,
                                          std::chrono::milliseconds timeout) {
  const auto to = endpoint(address);
  const std::array<Socket, 1> sockets;
  if (!to || sockets[0].fd() < 0 ||
      ::connect(sockets[0].fd(), reinterpret_cast<const sockaddr*>(&*to), sizeof *to) != 0)
    return std::nullopt;
  constexpr int kTries = 3;
  std::array<std::byte, 2048> buffer;
  for (int i = 0; i < kTries; ++i) {
    if (::send(sockets[0].fd(), command.data(), command.size(), 0) < 0) return std::nullopt;
    const auto packet = receive(sockets, Clock::now() + timeout / kTries, buffer);
    if (is_ack(packet, ack, payload)) return std::vector<std::byte>(packet.begin(), packet.end());
  }
  return std::nullopt;
}

// One bound socket an interface address, with the question already sent.
std::vector<Socket> ask_on(const std::vector<std::string>& interfaces) {
  std::vector<Socket> sockets;
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) return sockets;
  for (const ifaddrs* it = list; it != nullptr; it = it->ifa_next) {
    if (it->ifa_addr == nullptr || it->ifa_addr->sa_family != AF_INET || (it->ifa_flags & IFF_UP) == 0)
      continue;
    if (!interfaces.empty() &&
        std::find(interfaces.begin(), interfaces.end(), it->ifa_name) == interfaces.end())
      continue;
    sockaddr_in from{};
    std::memcpy(&from, it->ifa_addr, sizeof from);
    Socket socket;
    const int yes = 1;
    if (socket.fd() < 0 || ::bind(socket.fd(), reinterpret_cast<const sockaddr*>(&from), sizeof from) != 0 ||
        ::setsockopt(socket.fd(), SOL_SOCKET, SO_BROADCAST, &yes, sizeof yes) != 0)
      continue;
    sockaddr_in to = from;
    if ((it->ifa_flags & IFF_LOOPBACK) == 0 && (it->ifa_flags & IFF_BROADCAST) != 0 &&
        it->ifa_broadaddr != nullptr) {
      std::memcpy(&to, it->ifa_broadaddr, sizeof to);
      to.sin_port = htons(kGvcpPort);
      send(socket, discovery_command(true), to);
      to.sin_addr.s_addr = INADDR_BROADCAST;  // a device may sit in another subnet
    }
    to.sin_port = htons(kGvcpPort);
    send(socket, discovery_command(true), to);
    sockets.push_back(std::move(socket));
  }
  ::freeifaddrs(list);
  return sockets;
}

}  // namespace

std::optional<GvcpDevice> parse_discovery_ack(std::span<const std::byte> packet) {
  if (!is_ack(packet, kDiscoveryAck, kDiscoveryPayload)) return std::nullopt;
  // The payload is a copy of the device's first registers (GigE Vision 2.0, section 28).
  const std::byte* r = packet.data() + kHeader;
  GvcpDevice device;
  std::array<char, 24> line{};
  const std::uint32_t ip = get32(r + 0x24);
  std::snprintf(line.data(), line.size(), "%u.%u.%u.%u", ip >> 24, ip >> 16 & 0xff, ip >> 8 & 0xff,
                ip & 0xff);
  device.address = line.data();
  const std::uint32_t high = get32(r + 0x08), low = get32(r + 0x0c);
  std::snprintf(line.data(), line.size(), "%02x:%02x:%02x:%02x:%02x:%02x", high >> 8 & 0xff, high & 0xff,
                low >> 24, low >> 16 & 0xff, low >> 8 & 0xff, low & 0xff);
  device.mac = line.data();
  device.manufacturer = text(r + 0x48, 32);
  device.model = text(r + 0x68, 32);
  device.version = text(r + 0x88, 32);
  device.serial = text(r + 0xd8, 16);
  device.user_name = text(r + 0xe8, 16);
  return device;
}

std::optional<GvcpDevice> gvcp_probe(const std::string& address, std::chrono::milliseconds timeout) {
  const auto packet = ask(address, discovery_command(false), kDiscoveryAck, kDiscoveryPayload, timeout);
  if (!packet) return std::nullopt;
  auto device = parse_discovery_ack(*packet);
  if (device) device->address = address;  // the way it was reached
  return device;
}

std::optional<std::uint32_t> gvcp_read_register(const std::string& address, std::uint32_t reg,
                                                std::chrono::milliseconds timeout) {
  std::array<std::byte, kHeader + 4> command{};
  command[0] = kKey;
  command[1] = std::byte{0x01};
  put16(&command[2], kReadRegisterCommand);
  put16(&command[4], 4);
  put16(&command[6], 1);
  put16(&command[8], reg >> 16);
  put16(&command[10], reg & 0xffff);
  const auto packet = ask(address, command, kReadRegisterAck, 4, timeout);
  if (!packet) return std::nullopt;
  return get32(packet->data() + kHeader);
}

std::vector<GvcpDevice> gvcp_discover(std::chrono::milliseconds timeout,
                                      const std::vector<std::string>& interfaces) {
  std::vector<GvcpDevice> devices;
  const auto sockets = ask_on(interfaces);
  const auto deadline = Clock::now() + timeout;
  std::array<std::byte, 2048> buffer;
  for (;;) {
    const auto packet = receive(sockets, deadline, buffer);
    if (packet.empty()) break;
    const auto device = parse_discovery_ack(packet);
    const auto same = [&](const GvcpDevice& other) { return other.address == device->address; };
    if (device && std::none_of(devices.begin(), devices.end(), same)) devices.push_back(*device);
  }
  std::sort(devices.begin(), devices.end(),
            [](const GvcpDevice& a, const GvcpDevice& b) { return a.address < b.address; });
  return devices;
}

}  // namespace lightwell
