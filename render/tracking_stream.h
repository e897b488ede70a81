// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <set>
#include <string>

#include "interface/tracking_receiver.h"

namespace lightwell::render {

// The pose of a real camera, as a tracker sends it over UDP. Says on stderr, once each time, that it waits, who sends,
// that the stream stopped (the last pose is kept) and came back, and the first packet of a run of malformed ones.
class TrackingStream {
 public:
  // failed: the address is not this machine's, or the port is taken.
  static Result<TrackingStream> open(const TrackingOptions& options);

  // Takes all packets that have come, without waiting; true where they brought a newer pose.
  bool update();
  // Nothing before the first good packet.
  [[nodiscard]] const std::optional<TrackedCamera>& camera() const { return camera_; }
  [[nodiscard]] std::uint16_t port() const { return receiver_.port(); }
  [[nodiscard]] std::size_t malformed() const { return malformed_; }

 private:
  explicit TrackingStream(TrackingReceiver receiver) : receiver_(std::move(receiver)) {}
  void tell(bool arrived, const std::string& sender);

  enum class State { unknown, waiting, flowing, stopped };
  TrackingReceiver receiver_;
  std::optional<TrackedCamera> camera_;
  std::chrono::steady_clock::time_point last_;
  std::size_t malformed_ = 0;
  bool told_malformed_ = false;
  std::set<int> told_others_;  // numbers of cameras that are not followed
  State told_ = State::unknown;
};

}  // namespace lightwell::render
