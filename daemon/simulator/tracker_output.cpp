// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/simulator/tracker_output.h"

#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <vector>

#include "daemon/clock.h"
#include "interface/freed_packet.h"
#include "interface/opentrackio_packet.h"

namespace lightwell::simulator {
namespace {

constexpr std::int64_t kFramesStopped_ns = 1'000'000'000;
constexpr double kInstant_s = 1e-6;  // of a scene's moment that is asked for its middle alone

Error failure(const TrackerOptions& options, const std::string& what) {
  return {ErrorKind::failed, "--tracking-out: cannot send to " + options.to.address.host + ":" +
                                 std::to_string(options.to.address.port) + ": " + what};
}

}  // namespace

Result<std::unique_ptr<TrackerOutput>> TrackerOutput::start(const TrackerOptions& options,
                                                            std::shared_ptr<const Scene> scene) {
  if (!scene->at(0, kInstant_s).position_m)
    return Error{ErrorKind::usage,
                 "--tracking-out needs a scene in which the probe moves, allowed: --scenario walk"};
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  const std::string port = std::to_string(options.to.address.port);
  if (const int code = ::getaddrinfo(options.to.address.host.c_str(), port.c_str(), &hints, &found);
      code != 0)
    return failure(options, ::gai_strerror(code));
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> address(found, ::freeaddrinfo);
  const int socket = ::socket(address->ai_family, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket < 0) return failure(options, std::strerror(errno));
  if (::connect(socket, address->ai_addr, address->ai_addrlen) != 0) {
    const Error error = failure(options, std::strerror(errno));
    ::close(socket);
    return error;
  }
  return std::unique_ptr<TrackerOutput>(new TrackerOutput(options, std::move(scene), socket));
}

TrackerOutput::TrackerOutput(const TrackerOptions& options, std::shared_ptr<const Scene> scene, int socket)
    : options_(options), scene_(std::move(scene)), socket_(socket), thread_([this] { run(); }) {}

TrackerOutput::~TrackerOutput() {
  {
    const std::lock_guard lock(mutex_);
    running_ = false;
  }
  stop_.notify_all();
  thread_.join();
  ::close(socket_);
}

void TrackerOutput::frame(const SentFrame& frame) {
  if (frame.mid_exposure_mono_ns == 0) return;  // a black frame, of no moment of the scene
  const std::lock_guard lock(mutex_);
  anchor_ = {frame.mid_exposure_mono_ns, frame.truth.scene_s};
}

void TrackerOutput::run() {
  using Clock = std::chrono::steady_clock;
  const auto period =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / options_.rate_hz));
  std::unique_lock lock(mutex_);
  std::uint16_t sequence = 0;
  for (auto due = Clock::now();; due = std::max(due + period, Clock::now())) {
    if (stop_.wait_until(lock, due, [this] { return !running_; })) return;
    send(mono_now_ns(), sequence++);
  }
}

// Called with the lock held.
void TrackerOutput::send(std::int64_t now_ns, std::uint16_t sequence) const {
  if (!anchor_ || now_ns - anchor_->mono_ns > kFramesStopped_ns) return;
  const double scene_s =
      anchor_->scene_s + static_cast<double>(now_ns - anchor_->mono_ns) * 1e-9 - options_.lag_s;
  const double instant = std::max(scene_s, kInstant_s);
  const auto position = scene_->at(instant - kInstant_s / 2, instant + kInstant_s / 2).position_m;
  if (!position) return;
  TrackedCamera tracked = tracked_from_pose({*position, Eigen::Quaterniond::Identity()});
  tracked.sampled_ns = clock_ns(CLOCK_TAI);
  const std::vector<std::uint8_t> bytes = options_.to.protocol == TrackingProtocol::freed
                                              ? freed_message({1, tracked, 0, 0})
                                              : opentrackio_datagram(tracked, sequence);
  // Nobody need be listening.
  (void)::send(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
}

}  // namespace lightwell::simulator
