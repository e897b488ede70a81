// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/device_clock.h"

#include <algorithm>

namespace lightwell {

void DeviceClock::roll(std::int64_t received_mono_ns) noexcept {
  if (received_mono_ns - window_start_ns_ < kWindowNs) return;
  if (previous_floor_ns_ != kNone) {
    const std::int64_t moved =
        floor_ns_ > previous_floor_ns_ ? floor_ns_ - previous_floor_ns_ : previous_floor_ns_ - floor_ns_;
    wrong_rate_ = moved > (received_mono_ns - window_start_ns_) / 500;
  }
  previous_floor_ns_ = floor_ns_;
  floor_ns_ = kNone;
  window_start_ns_ = received_mono_ns;
}

std::int64_t DeviceClock::undelayed_mono_ns(std::uint64_t t_device_ns,
                                            std::int64_t received_mono_ns) noexcept {
  if (t_device_ns <= last_device_ns_) {
    reset();
    last_device_ns_ = t_device_ns;
    if (t_device_ns == 0) return received_mono_ns;
  }
  // Modular on purpose: a device may count from any value.
  const auto offset = static_cast<std::int64_t>(static_cast<std::uint64_t>(received_mono_ns) - t_device_ns);
  const bool jumped =
      floor_ns_ != kNone && (offset > floor_ns_ ? offset - floor_ns_ : floor_ns_ - offset) > kJumpNs;
  if (jumped) reset();
  last_device_ns_ = t_device_ns;
  if (window_start_ns_ == 0) window_start_ns_ = received_mono_ns;
  if (floor_ns_ != kNone) roll(received_mono_ns);
  floor_ns_ = std::min(floor_ns_, offset);
  if (wrong_rate_) return received_mono_ns;
  const std::int64_t floor = std::min(floor_ns_, previous_floor_ns_);
  return static_cast<std::int64_t>(t_device_ns + static_cast<std::uint64_t>(floor));
}

}  // namespace lightwell
