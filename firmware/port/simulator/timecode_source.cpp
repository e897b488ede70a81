// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/port/simulator/timecode_source.h"

#include <algorithm>
#include <cmath>

namespace lightwell::sync_simulator {
namespace {

constexpr std::size_t kHalves = 160;
constexpr std::uint32_t kSync = 0xbffc;  // 0011111111111101, sent from the left

}  // namespace

TimecodeSource::TimecodeSource(double frames_a_second, int start_s)
    : frames_a_second_(frames_a_second),
      base_(static_cast<std::int64_t>(std::ceil(frames_a_second - 1e-9))),
      first_(start_s * base_) {
  encode();
}

double TimecodeSource::next() const {
  return (static_cast<double>(frame_) + static_cast<double>(half_) / kHalves) / frames_a_second_;
}

// Biphase mark: an edge where a bit begins, another in the middle of a one.
void TimecodeSource::advance() {
  half_ += half_ % 2 == 0 && bits_[half_ / 2] ? 1 : 2 - half_ % 2;
  if (half_ < kHalves) return;
  half_ = 0;
  ++frame_;
  encode();
}

void TimecodeSource::encode() {
  bits_.fill(false);
  const auto put = [&](std::size_t at, std::int64_t value, int count) {
    for (int i = 0; i < count; ++i) bits_[at + static_cast<std::size_t>(i)] = (value >> i & 1) != 0;
  };
  const std::int64_t count = (first_ + frame_) % (24 * 3600 * base_);
  const std::int64_t frames = count % base_, seconds = count / base_ % 60, minutes = count / base_ / 60 % 60,
                     hours = count / base_ / 3600;
  put(0, frames % 10, 4), put(8, frames / 10, 2);
  put(16, seconds % 10, 4), put(24, seconds / 10, 3);
  put(32, minutes % 10, 4), put(40, minutes / 10, 3);
  put(48, hours % 10, 4), put(56, hours / 10, 2);
  put(64, kSync, 16);
  // The polarity bit makes the number of ones even, so that every word begins with an edge of the same sense.
  const bool odd = std::count(bits_.begin(), bits_.end(), true) % 2 != 0;
  bits_[base_ == 25 ? 59 : 27] = odd;
}

}  // namespace lightwell::sync_simulator
