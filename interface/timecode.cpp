// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/timecode.h"

#include <array>
#include <cstddef>
#include <cstdio>

namespace lightwell {
namespace {

constexpr std::int64_t kMinutesADay = 24 * 60;

// Numbers left out at the begin of a minute: 2 of 30, 4 of 60.
std::int64_t dropped(int frames_a_second) {
  return frames_a_second / 15;
}

std::int64_t frames_a_day(int frames_a_second, bool drop_frame) {
  const std::int64_t whole = kMinutesADay * 60 * frames_a_second;
  return drop_frame ? whole - dropped(frames_a_second) * (kMinutesADay - kMinutesADay / 10) : whole;
}

std::int64_t count_of(const Timecode& t, int frames_a_second) {
  const std::int64_t minutes = t.hours * 60 + t.minutes;
  const std::int64_t whole = (minutes * 60 + t.seconds) * frames_a_second + t.frames;
  return t.drop_frame ? whole - dropped(frames_a_second) * (minutes - minutes / 10) : whole;
}

}  // namespace

std::string timecode_text(const Timecode& t) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%02d:%02d:%02d%c%02d", t.hours % 100, t.minutes % 100,
                t.seconds % 100, t.drop_frame ? ';' : ':', t.frames % 100);
  return text.data();
}

std::optional<Timecode> parse_timecode(std::string_view text) {
  constexpr std::string_view kShape = "00:00:00:00";
  if (text.size() != kShape.size()) return std::nullopt;
  std::array<std::uint8_t, 4> parts{};
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool digit = text[i] >= '0' && text[i] <= '9';
    if (kShape[i] == '0' ? !digit : text[i] != ':' && !(i == 8 && text[i] == ';')) return std::nullopt;
    if (digit) parts[i / 3] = static_cast<std::uint8_t>(parts[i / 3] * 10 + (text[i] - '0'));
  }
  if (parts[0] > 23 || parts[1] > 59 || parts[2] > 59 || parts[3] > 59) return std::nullopt;
  return Timecode{parts[0], parts[1], parts[2], parts[3], text[8] == ';'};
}

Timecode later(const Timecode& timecode, std::int64_t frames, int frames_a_second) {
  const std::int64_t day = frames_a_day(frames_a_second, timecode.drop_frame);
  std::int64_t count = (count_of(timecode, frames_a_second) + frames) % day;
  if (count < 0) count += day;
  if (timecode.drop_frame) {  // put back the numbers that are left out, then read it as a clock
    const std::int64_t drop = dropped(frames_a_second);
    const std::int64_t ten_minutes = 600 * frames_a_second - 9 * drop;
    const std::int64_t minute = 60 * frames_a_second - drop;  // but the first of ten, which is whole
    const std::int64_t tens = count / ten_minutes, rest = count % ten_minutes;
    count += tens * 9 * drop;
    if (rest >= 60 * frames_a_second) count += drop * (1 + (rest - 60 * frames_a_second) / minute);
  }
  const std::int64_t seconds = count / frames_a_second;
  return {static_cast<std::uint8_t>(seconds / 3600), static_cast<std::uint8_t>(seconds / 60 % 60),
          static_cast<std::uint8_t>(seconds % 60), static_cast<std::uint8_t>(count % frames_a_second),
          timecode.drop_frame};
}

}  // namespace lightwell
