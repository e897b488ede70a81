// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/tracking_stream.h"

#include <utility>

#include "render/say.h"

namespace lightwell::render {

Result<TrackingStream> TrackingStream::open(const TrackingOptions& options) {
  auto receiver = TrackingReceiver::open(options);
  if (!receiver) return receiver.error();
  return TrackingStream(*std::move(receiver));
}

bool TrackingStream::update() {
  static constexpr int kMostAtOnce = 1000;  // a flood must not keep the picture from being drawn
  bool arrived = false;
  std::string sender;
  for (int i = 0; i < kMostAtOnce; ++i) {
    auto arrival = receiver_.next();
    if (!arrival) break;
    if (!arrival->camera) {
      ++malformed_;
      if (!std::exchange(told_malformed_, true))
        say("tracking: " + arrival->camera.error().message + " (from " + arrival->sender + "); ignored");
      continue;
    }
    if (arrival->other_camera && told_others_.insert(*arrival->other_camera).second)
      say("tracking: camera " + std::to_string(*arrival->other_camera) + " (from " + arrival->sender +
          ") is left out: camera " + std::to_string(receiver_.camera().value_or(0)) + " is followed");
    if (!*arrival->camera) continue;
    told_malformed_ = false;
    camera_ = **arrival->camera;
    sender = arrival->sender;
    arrived = true;
  }
  tell(arrived, sender);
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
