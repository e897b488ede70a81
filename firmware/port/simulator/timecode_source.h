// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace lightwell::sync_simulator {

// A timecode generator on set (SMPTE ST 12-1, not drop-frame): the times of its signal's edges, one after the other.
class TimecodeSource {
 public:
  // frames_a_second: exact, as 30000/1001; it counts to the whole number above. start_s: seconds since
  // midnight of the first frame.
  TimecodeSource(double frames_a_second, int start_s);

  // Seconds of its own clock at which the next edge lies; then the one after it.
  [[nodiscard]] double next() const;
  void advance();

 private:
  void encode();

  double frames_a_second_;
  std::int64_t base_;       // numbers a second
  std::int64_t first_;      // of the first frame, since midnight
  std::int64_t frame_ = 0;  // since the start
  std::size_t half_ = 0;    // of the frame's 160 half bits, where the next edge lies
  std::array<bool, 80> bits_{};
};

}  // namespace lightwell::sync_simulator
