// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/timecode.h"

#include <gtest/gtest.h>

namespace lightwell {
namespace {

Timecode at(const char* text) {
  const auto timecode = parse_timecode(text);
  EXPECT_TRUE(timecode) << text;
  return timecode.value_or(Timecode());
}
std::string after(const char* text, std::int64_t frames, int rate) {
  return timecode_text(later(at(text), frames, rate));
}

TEST(Timecode, IsReadAsItIsWritten) {
  for (const char* text : {"00:00:00:00", "23:59:59:24", "01:02:03;04", "10:00:59:59"})
    EXPECT_EQ(timecode_text(at(text)), text);
  for (const char* text : {"", "1:02:03:04", "24:00:00:00", "00:60:00:00", "00:00:60:00", "00:00:00:60",
                           "00;00:00:00", "00:00:00.00", "00:00:00:0x", "00:00:00:000"})
    EXPECT_FALSE(parse_timecode(text)) << text;
}

TEST(Timecode, CountsOverEveryBorderAndBack) {
  EXPECT_EQ(after("00:00:00:24", 1, 25), "00:00:01:00");
  EXPECT_EQ(after("00:59:59:23", 1, 24), "01:00:00:00");
  EXPECT_EQ(after("23:59:59:29", 1, 30), "00:00:00:00");
  EXPECT_EQ(after("00:00:00:00", -1, 30), "23:59:59:29");
  EXPECT_EQ(after("12:00:00:00", 25 * 86400, 25), "12:00:00:00");
  EXPECT_EQ(after("12:00:00:00", -3, 25), "11:59:59:22");
}

// SMPTE ST 12-1: numbers 0 and 1 of every minute are left out, but of minutes 0, 10, 20 …; at 60 four of them.
TEST(Timecode, DropFrameLeavesOutItsNumbersAndNoOthers) {
  EXPECT_EQ(after("00:00:59;29", 1, 30), "00:01:00;02");
  EXPECT_EQ(after("00:01:00;02", -1, 30), "00:00:59;29");
  EXPECT_EQ(after("00:09:59;29", 1, 30), "00:10:00;00");
  EXPECT_EQ(after("00:10:59;29", 1, 30), "00:11:00;02");
  EXPECT_EQ(after("23:59:59;29", 1, 30), "00:00:00;00");
  EXPECT_EQ(after("00:00:59;59", 1, 60), "00:01:00;04");
  EXPECT_EQ(after("00:00:00;00", 107892, 30), "01:00:00;00") << "frames of an hour at 30000/1001";
}

// Every number of a day comes once, in order, and the count back is the count there.
TEST(Timecode, ADayOfDropFrameIsWalkedWithoutARepeat) {
  Timecode walked{0, 0, 0, 0, true};
  const Timecode start = walked;
  for (std::int64_t n = 1; n <= 2'589'408; ++n) {
    const Timecode next = later(walked, 1, 30);
    const bool dropped = next.seconds == 0 && next.minutes % 10 != 0 && next.frames < 2;
    ASSERT_FALSE(dropped) << timecode_text(next);
    if (n % 1009 == 0) {
      ASSERT_EQ(later(start, n, 30), next);
      ASSERT_EQ(later(next, -n, 30), start);
    }
    walked = next;
  }
  EXPECT_EQ(walked, start) << "24 hours of 30000/1001";
}

}  // namespace
}  // namespace lightwell
