// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/tracking_receiver.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <memory>
#include <utility>

#include "interface/freed_packet.h"

namespace lightwell {
namespace {

Error failure(const HostPort& address, const std::string& what) {
  return {ErrorKind::failed,
          "--tracking: cannot listen on " + address.host + ":" + std::to_string(address.port) + ": " + what};
}

std::string host_of(const sockaddr_storage& sender) {
  char text[INET6_ADDRSTRLEN] = "?";
  if (sender.ss_family == AF_INET) {
    sockaddr_in v4{};
    std::memcpy(&v4, &sender, sizeof v4);
    ::inet_ntop(AF_INET, &v4.sin_addr, text, sizeof text);
  } else if (sender.ss_family == AF_INET6) {
    sockaddr_in6 v6{};
    std::memcpy(&v6, &sender, sizeof v6);
    ::inet_ntop(AF_INET6, &v6.sin6_addr, text, sizeof text);
  }
  return text;
}

// Membership of the group, where the address is one of IPv4's.
Status join(int socket, const addrinfo& address) {
  if (address.ai_family != AF_INET) return {};
  sockaddr_in v4{};
  std::memcpy(&v4, address.ai_addr, sizeof v4);
  if (!IN_MULTICAST(ntohl(v4.sin_addr.s_addr))) return {};
  ip_mreq request{};
  request.imr_multiaddr = v4.sin_addr;
  if (::setsockopt(socket, IPPROTO_IP, IP_ADD_MEMBERSHIP, &request, sizeof request) != 0)
    return Error{ErrorKind::failed, std::strerror(errno)};
  return {};
}

std::int64_t ns_of(const timespec& t) {
  return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}
std::int64_t now_ns(clockid_t clock) {
  timespec t{};
  ::clock_gettime(clock, &t);
  return ns_of(t);
}

// The kernel stamps arrivals by the real-time clock: how long ago that was does not depend on when this thread ran.
std::int64_t arrival_mono_ns(msghdr& message) {
  constexpr std::int64_t kLongestWait_ns = 10'000'000'000;
  const std::int64_t now = now_ns(CLOCK_MONOTONIC), now_real = now_ns(CLOCK_REALTIME);
  for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
    if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SCM_TIMESTAMPNS) continue;
    timespec stamp{};
    std::memcpy(&stamp, CMSG_DATA(c), sizeof stamp);
    const std::int64_t age = now_real - ns_of(stamp);
    if (age >= 0 && age < kLongestWait_ns) return now - age;  // else the clock was set meanwhile
  }
  return now;
}

}  // namespace

Result<TrackingOptions> parse_tracking(const std::string& text, const std::string& option) {
  TrackingOptions options;
  const auto colon = text.find(':');
  const std::string protocol = text.substr(0, colon);
  if (protocol == "freed")
    options.protocol = TrackingProtocol::freed;
  else if (protocol != "opentrackio" || colon == std::string::npos)
    return Error{ErrorKind::usage,
                 option + " " + text + ": must be opentrackio:ADDRESS:PORT or freed:ADDRESS:PORT"};
  auto address = parse_host_port(colon == std::string::npos ? "" : text.substr(colon + 1));
  if (!address) return Error{ErrorKind::usage, option + " " + text + ": " + address.error().message};
  options.address = *address;
  return options;
}

Result<TrackingReceiver> TrackingReceiver::open(const TrackingOptions& options) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  const std::string port = std::to_string(options.address.port);
  if (const int code = ::getaddrinfo(options.address.host.c_str(), port.c_str(), &hints, &found); code != 0)
    return failure(options.address, ::gai_strerror(code));
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> address(found, ::freeaddrinfo);
  const int socket = ::socket(address->ai_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (socket < 0) return failure(options.address, std::strerror(errno));
  TrackingReceiver receiver(options, socket);
  const int on = 1;  // where it cannot be had, arrivals are stamped when they are read
  (void)::setsockopt(socket, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
  if (::bind(socket, address->ai_addr, address->ai_addrlen) != 0)
    return failure(options.address, std::strerror(errno));
  if (Status s = join(socket, *address); !s) return failure(options.address, s.error().message);
  return receiver;
}

TrackingReceiver::TrackingReceiver(TrackingReceiver&& other) noexcept
    : options_(std::move(other.options_)),
      socket_(std::exchange(other.socket_, -1)),
      reader_(std::move(other.reader_)) {}

TrackingReceiver::~TrackingReceiver() {
  if (socket_ >= 0) ::close(socket_);
}

std::uint16_t TrackingReceiver::port() const {
  sockaddr_storage own{};
  socklen_t size = sizeof own;
  if (::getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &size) != 0) return 0;
  std::uint16_t port = 0;  // in the same place of both families
  std::memcpy(&port, reinterpret_cast<const char*>(&own) + sizeof own.ss_family, sizeof port);
  return ntohs(port);
}

Result<std::optional<TrackedCamera>> TrackingReceiver::parse(std::span<const std::uint8_t> datagram) {
  if (options_.protocol == TrackingProtocol::opentrackio) {
    auto camera = reader_.take(datagram);
    if (camera && *camera && !(*camera)->sensor_height_mm)
      (*camera)->sensor_height_mm = options_.sensor_height_mm;
    return camera;
  }
  auto packet = parse_freed(datagram);
  if (!packet) return packet.error();
  if (options_.freed_mm_per_unit && packet->zoom > 0)
    packet->camera.focal_length_mm = packet->zoom * *options_.freed_mm_per_unit;
  packet->camera.sensor_height_mm = options_.sensor_height_mm;
  return std::optional<TrackedCamera>(packet->camera);
}

std::optional<TrackingArrival> TrackingReceiver::next(std::chrono::milliseconds patience) {
  if (patience.count() > 0) {
    pollfd readable{socket_, POLLIN, 0};
    if (::poll(&readable, 1, static_cast<int>(patience.count())) <= 0) return std::nullopt;
  }
  std::array<std::uint8_t, 65536> buffer;  // the longest datagram; not cleared for every packet
  alignas(cmsghdr) std::array<char, 256> control{};
  sockaddr_storage sender{};
  iovec data{buffer.data(), buffer.size()};
  msghdr message{};
  message.msg_name = &sender;
  message.msg_namelen = sizeof sender;
  message.msg_iov = &data;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t length = ::recvmsg(socket_, &message, 0);
  if (length < 0) return std::nullopt;
  TrackingArrival arrival{arrival_mono_ns(message),
                          host_of(sender),
                          {},
                          parse(std::span(buffer).first(static_cast<std::size_t>(length)))};
  if (arrival.camera && *arrival.camera && (*arrival.camera)->number) {
    const int number = *(*arrival.camera)->number;
    if (!options_.camera) options_.camera = number;
    if (number != *options_.camera) {
      arrival.other_camera = number;
      arrival.camera = std::optional<TrackedCamera>();
    }
  }
  return arrival;
}

}  // namespace lightwell
