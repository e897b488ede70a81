// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/recorded_times.h"

#include <algorithm>
#include <cmath>

#include "daemon/clock.h"

namespace lightwell {
namespace {

// Recorded times can be anything; their sums wrap rather than overflow.
std::int64_t add(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}
std::int64_t subtract(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
}

}  // namespace

std::int64_t RecordedTimes::period_ns() const {
  constexpr double kUnknownRateHz = 25;  // a film's pace, where the take does not say
  return std::llround(1e9 / (rate_hz_ > 0 ? rate_hz_ : kUnknownRateHz));
}

// From the last frame to this one, at speed 1. Times that run backwards or leap an hour are no pace to play
// by.
std::int64_t RecordedTimes::step_ns(const RecordedFrame& recorded) const {
  constexpr std::int64_t kHourNs = 3'600'000'000'000;
  if (again_ || !last_) return period_ns();
  const std::int64_t step = subtract(recorded.capture_mono_ns, last_->capture_mono_ns);
  return step >= 0 && step <= kHourNs ? step : period_ns();
}

std::uint64_t RecordedTimes::lost_before(const RecordedFrame& recorded) const {
  if (!last_ || again_ || recorded.sequence <= last_->sequence) return 0;
  return recorded.sequence - last_->sequence - 1;
}

void RecordedTimes::begin_again() {
  if (!first_ || !last_) return;
  again_ = true;
  sequence_shift_ += last_->sequence - first_->sequence + 1;
  time_shift_ns_ =
      add(time_shift_ns_, add(subtract(last_->capture_mono_ns, first_->capture_mono_ns), period_ns()));
}

RecordedTimes::Played RecordedTimes::play(const RecordedFrame& recorded) {
  Played played{recorded, 0};
  played.frame.sequence += sequence_shift_;
  if (speed_ > 0) {
    constexpr std::int64_t kSecondNs = 1'000'000'000;  // no camera takes longer from exposure to reception
    constexpr double kForeverNs = 1e15;                // eleven days: a speed near 0 must not overflow
    if (!last_) {
      due_mono_ns_ = mono_now_ns();
      utc_minus_mono_ns_ = utc_now_ns() - due_mono_ns_;
    } else {
      due_mono_ns_ += std::llround(std::min(static_cast<double>(step_ns(recorded)) / speed_, kForeverNs));
    }
    const std::int64_t transfer = subtract(recorded.received_mono_ns, recorded.capture_mono_ns);
    played.due_mono_ns = played.frame.received_mono_ns = due_mono_ns_;
    played.frame.capture_mono_ns = due_mono_ns_ - std::clamp(transfer, std::int64_t{0}, kSecondNs);
    played.frame.capture_utc_ns = played.frame.capture_mono_ns + utc_minus_mono_ns_;
  } else if (time_shift_ns_ != 0) {
    played.frame.capture_mono_ns = add(recorded.capture_mono_ns, time_shift_ns_);
    played.frame.received_mono_ns = add(recorded.received_mono_ns, time_shift_ns_);
    played.frame.capture_utc_ns = add(recorded.capture_utc_ns, time_shift_ns_);
  }
  if (!first_) first_ = recorded;
  last_ = recorded;
  again_ = false;
  return played;
}

}  // namespace lightwell
