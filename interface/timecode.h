// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace lightwell {

// A production's label of a frame (SMPTE ST 12-1).
struct Timecode {
  std::uint8_t hours = 0, minutes = 0, seconds = 0, frames = 0;
  bool drop_frame = false;  // frames 0 and 1 (at 60: 0 to 3) of a minute are left out, but of every tenth
  bool operator==(const Timecode&) const = default;
};

// "hh:mm:ss:ff"; a semicolon before the frames where some are dropped.
std::string timecode_text(const Timecode& timecode);
// As written above; empty for anything else, a clock that does not exist included.
std::optional<Timecode> parse_timecode(std::string_view text);

// The label `frames` later (earlier: negative), at so many frames a second, 24 to 60: what a rate of 30000/1001 counts
// is 30. Round at midnight.
Timecode later(const Timecode& timecode, std::int64_t frames, int frames_a_second);

}  // namespace lightwell
