// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "daemon/simulator/frame_generator.h"

namespace lightwell::simulator {

// What the camera's registers ask for.
struct CameraSettings {
  PixelFormat pixel_format = PixelFormat::mono12;
  double exposure_us = 0;
  std::int64_t period_us = 0;
  friend bool operator==(const CameraSettings&, const CameraSettings&) = default;
};

// A frame that left the camera.
struct SentFrame {
  std::uint64_t frame = 0;     // counts from 0 without gaps
  std::uint16_t frame_id = 0;  // as on the wire: wraps
  std::int64_t mid_exposure_mono_ns = 0;
  double exposure_us = 0;
  FrameTruth truth;
};

// Frames made ahead of time by a thread of its own, so that the protocol's thread only copies.
//
// The camera sends at whole multiples of the period on the system's real-time clock (that is how Aravis's
// fake camera keeps time). Each frame is made for one such instant, shows the exposure that ends there, and
// its scene time counts periods since the first frame: content depends on settings, seed and count, not on
// the clock. Frames that nobody took in time are replaced by fresh ones.
class PreparedFrames {
 public:
  // settings is asked from the worker's thread before every frame; sent is called there, in order, for every
  // frame that was taken.
  PreparedFrames(FrameGenerator generator, std::function<CameraSettings()> settings,
                 std::function<void(const SentFrame&)> sent);
  ~PreparedFrames();
  PreparedFrames(const PreparedFrames&) = delete;
  PreparedFrames& operator=(const PreparedFrames&) = delete;

  // Copies the frame that is due into out (its format's bytes) and returns its mid-exposure time,
  // CLOCK_MONOTONIC. Waits up to a second where none is ready (after a change of settings), then gives a
  // black frame that counts as not sent: 0.
  std::int64_t take(const CameraSettings& wanted, std::uint16_t frame_id, std::span<std::byte> out);

  // Ends the thread after the last taken frame has been told to `sent`.
  void stop();
  [[nodiscard]] std::uint64_t taken() const;

 private:
  enum class State { free, making, ready, copying };
  struct Slot {
    State state = State::free;
    CameraSettings settings;
    std::int64_t due_real_us = 0;
    std::vector<std::byte> bytes;
    FrameTruth truth;
  };

  void run();
  Slot* slot_to_fill();
  void make(Slot& slot);
  Slot* oldest_ready();
  void drop_stale(const CameraSettings& wanted, std::int64_t now_real_us);
  void tell(std::unique_lock<std::mutex>& lock);

  FrameGenerator generator_;
  std::function<CameraSettings()> settings_;
  std::function<void(const SentFrame&)> sent_;

  mutable std::mutex mutex_;
  std::condition_variable work_, ready_;
  bool running_ = true;
  std::array<Slot, 16> slots_;  // as many in use as kAhead takes
  std::vector<SentFrame> to_tell_;
  std::uint64_t taken_ = 0;
  std::int64_t last_due_us_ = 0;  // worker only
  std::int64_t period_us_ = 0;    // of the last frame made; worker only
  double scene_s_ = 0;            // worker only
  std::uint64_t made_ = 0;        // worker only
  std::thread thread_;            // last: starts when all else is there
};

}  // namespace lightwell::simulator
