// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/tracking_stream.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <utility>

#include "render/freed_packet.h"
#include "render/say.h"

namespace lightwell::render {
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

}  // namespace

Result<TrackingOptions> parse_tracking(const std::string& text) {
  TrackingOptions options;
  const auto colon = text.find(':');
  const std::string protocol = text.substr(0, colon);
  if (protocol == "freed")
    options.protocol = TrackingProtocol::freed;
  else if (protocol != "opentrackio" || colon == std::string::npos)
    return Error{ErrorKind::usage,
                 "--tracking " + text + ": must be opentrackio:ADDRESS:PORT or freed:ADDRESS:PORT"};
  auto address = parse_host_port(colon == std::string::npos ? "" : text.substr(colon + 1));
  if (!address) return Error{ErrorKind::usage, "--tracking " + text + ": " + address.error().message};
  options.address = *address;
  return options;
}

Result<TrackingStream> TrackingStream::open(const TrackingOptions& options) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  const std::string port = std::to_string(options.address.port);
  if (const int code = ::getaddrinfo(options.address.host.c_str(), port.c_str(), &hints, &found); code != 0)
    return failure(options.address, ::gai_strerror(code));
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> address(found, ::freeaddrinfo);
  const int socket = ::socket(address->ai_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (socket < 0) return failure(options.address, std::strerror(errno));
  TrackingStream stream(options, socket);
  if (::bind(socket, address->ai_addr, address->ai_addrlen) != 0)
    return failure(options.address, std::strerror(errno));
  if (Status s = join(socket, *address); !s) return failure(options.address, s.error().message);
  return stream;
}

TrackingStream::TrackingStream(TrackingStream&& other) noexcept
    : options_(std::move(other.options_)),
      socket_(std::exchange(other.socket_, -1)),
      reader_(std::move(other.reader_)),
      camera_(other.camera_),
      last_(other.last_),
      malformed_(other.malformed_),
      told_malformed_(other.told_malformed_),
      told_(other.told_) {}

TrackingStream::~TrackingStream() {
  if (socket_ >= 0) ::close(socket_);
}

std::uint16_t TrackingStream::port() const {
  sockaddr_storage own{};
  socklen_t size = sizeof own;
  if (::getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &size) != 0) return 0;
  std::uint16_t port = 0;  // in the same place of both families
  std::memcpy(&port, reinterpret_cast<const char*>(&own) + sizeof own.ss_family, sizeof port);
  return ntohs(port);
}

Result<std::optional<TrackedCamera>> TrackingStream::parse(std::span<const std::uint8_t> datagram) {
  if (options_.protocol == TrackingProtocol::opentrackio) return reader_.take(datagram);
  auto packet = parse_freed(datagram);
  if (!packet) return packet.error();
  if (options_.freed_mm_per_unit && packet->zoom > 0)
    packet->camera.focal_length_mm = packet->zoom * *options_.freed_mm_per_unit;
  return std::optional<TrackedCamera>(packet->camera);
}

bool TrackingStream::update() {
  static constexpr int kMostAtOnce = 1000;  // a flood must not keep the picture from being drawn
  std::array<std::uint8_t, 65536> buffer{};
  bool arrived = false;
  sockaddr_storage sender{};
  for (int i = 0; i < kMostAtOnce; ++i) {
    socklen_t size = sizeof sender;
    const ssize_t length =
        ::recvfrom(socket_, buffer.data(), buffer.size(), 0, reinterpret_cast<sockaddr*>(&sender), &size);
    if (length < 0) break;
    auto camera = parse(std::span(buffer).first(static_cast<std::size_t>(length)));
    if (!camera) {
      ++malformed_;
      if (!std::exchange(told_malformed_, true))
        say("tracking: " + camera.error().message + " (from " + host_of(sender) + "); ignored");
      continue;
    }
    if (!*camera) continue;
    told_malformed_ = false;
    camera_ = **camera;
    if (!camera_->sensor_height_mm) camera_->sensor_height_mm = options_.sensor_height_mm;
    arrived = true;
  }
  tell(arrived, arrived ? host_of(sender) : "");
  return arrived;
}

void TrackingStream::tell(bool arrived, const std::string& sender) {
  using namespace std::chrono_literals;
  const auto now = std::chrono::steady_clock::now();
  if (arrived) last_ = now;
  const State state = !camera_                      ? State::waiting
                      : arrived || now - last_ < 1s ? State::flowing
                                                    : State::stopped;
  if (state == told_) return;
  if (state == State::waiting) say("waiting for tracking on port " + std::to_string(port()));
  if (state == State::flowing) say("tracking from " + sender);
  if (state == State::stopped) say("no tracking for 1 s; keeping the last pose");
  told_ = state;
}

}  // namespace lightwell::render
