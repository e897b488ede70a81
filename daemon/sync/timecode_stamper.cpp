// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/timecode_stamper.h"

#include <cmath>

namespace lightwell {
namespace {

constexpr double kShortestNs = 1e9 / 61,
                 kLongestNs = 1e9 / 23;  // a frame's period, 24000/1001 to 60 a second

}  // namespace

// The period is learned from words that name frames in a row: whatever rate LTC has, it says itself.
void TimecodeStamper::word(const Timecode& timecode, std::int64_t start_mono_ns) noexcept {
  const std::scoped_lock lock(mutex_);
  Word next{timecode, start_mono_ns};
  if (newest_ && start_mono_ns > newest_->start_mono_ns) {
    const auto period_ns = static_cast<double>(start_mono_ns - newest_->start_mono_ns);
    const bool plausible = period_ns > kShortestNs && period_ns < kLongestNs;
    const int rate = plausible ? static_cast<int>(std::lround(1e9 / period_ns)) : newest_->frames_a_second;
    if (rate > 0 && later(newest_->timecode, 1, rate) == timecode && plausible) {
      const bool steady = newest_->frames_a_second == rate;
      next.period_ns = steady ? newest_->period_ns + (period_ns - newest_->period_ns) / 8 : period_ns;
      next.frames_a_second = rate;
    } else if (rate > 0) {  // a word was lost, or the clock was set: the rate is what it was
      next.period_ns = newest_->period_ns;
      next.frames_a_second = newest_->frames_a_second;
    }
  }
  newest_ = next;
}

bool TimecodeStamper::stamp(FrameInfo& info) noexcept {
  if (!used_.load(std::memory_order_relaxed) || info.timecode) return false;
  {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (lock && newest_) used_word_ = *newest_, any_ = true;
  }
  if (!any_ || used_word_.frames_a_second == 0) return false;
  const std::int64_t since_ns = info.capture_mono_ns - used_word_.start_mono_ns;
  if (since_ns > kBelievedNs || since_ns < -kBelievedNs) return false;
  const auto frames =
      static_cast<std::int64_t>(std::floor(static_cast<double>(since_ns) / used_word_.period_ns));
  info.timecode = later(used_word_.timecode, frames, used_word_.frames_a_second);
  return true;
}

}  // namespace lightwell
