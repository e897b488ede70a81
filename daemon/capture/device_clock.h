// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

namespace lightwell {

// Takes the jitter of network and scheduler out of reception times with the help of the device's own clock.
// The difference reception − device time has a floor, the delay nothing can undercut; a frame's undelayed
// reception time is its device time plus that floor, followed over a few seconds so that the clocks may
// drift. What instant of the exposure the device stamps does not matter: it is part of the floor. not
// thread-safe, allocates nothing source: the minimum filter of network time synchronisation (Mills, RFC 5905,
// section 10)
class DeviceClock {
 public:
  // When the frame would have been received without delay; never after received_mono_ns. That itself where
  // the device's clock is absent (0), stands still, jumps, or runs more than 0.2 % wrong.
  std::int64_t undelayed_mono_ns(std::uint64_t t_device_ns, std::int64_t received_mono_ns) noexcept;
  void reset() noexcept { *this = DeviceClock(); }

 private:
  static constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();
  static constexpr std::int64_t kWindowNs = 2'000'000'000;  // 50 ppm of drift make 0.1 ms in it
  static constexpr std::int64_t kJumpNs = 1'000'000'000;  // no frame is delayed by this much and still whole

  void roll(std::int64_t received_mono_ns) noexcept;

  std::uint64_t last_device_ns_ = 0;
  std::int64_t window_start_ns_ = 0;
  std::int64_t floor_ns_ = kNone;           // in this window
  std::int64_t previous_floor_ns_ = kNone;  // in the one before
  bool wrong_rate_ = false;
};

}  // namespace lightwell
