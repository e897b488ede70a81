// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "interface/recording.h"

namespace lightwell {

// Moves a take's times and numbers to those of its playing; see make_recording_source for the rules.
class RecordedTimes {
 public:
  RecordedTimes(double speed, double rate_hz) : speed_(speed), rate_hz_(rate_hz) {}

  struct Played {
    RecordedFrame frame;
    std::int64_t due_mono_ns = 0;  // when to hand it out; 0 at speed 0
  };
  Played play(const RecordedFrame& recorded);
  // Frames the camera lost between the last played and this one.
  [[nodiscard]] std::uint64_t lost_before(const RecordedFrame& recorded) const;
  // The first frame follows again.
  void begin_again();

 private:
  [[nodiscard]] std::int64_t step_ns(const RecordedFrame& recorded) const;
  [[nodiscard]] std::int64_t period_ns() const;

  double speed_;
  double rate_hz_;
  std::optional<RecordedFrame> first_, last_;
  bool again_ = false;
  std::int64_t due_mono_ns_ = 0;
  std::int64_t utc_minus_mono_ns_ = 0;
  std::uint64_t sequence_shift_ = 0;
  std::int64_t time_shift_ns_ = 0;  // speed 0, from the second pass on
};

}  // namespace lightwell
