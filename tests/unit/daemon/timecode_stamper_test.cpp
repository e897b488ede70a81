// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/timecode_stamper.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace lightwell {
namespace {

// LTC of a rate from 10:00:00:00 at time 0, told as the board tells it.
class TimecodeStampers : public ::testing::TestWithParam<double> {
 protected:
  [[nodiscard]] int base() const { return static_cast<int>(std::ceil(GetParam() - 1e-9)); }
  [[nodiscard]] std::int64_t start_ns(std::int64_t n) const {
    return std::llround(static_cast<double>(n) * 1e9 / GetParam());
  }
  [[nodiscard]] Timecode code(std::int64_t n) const { return later({10, 0, 0, 0, false}, n, base()); }
  void tell(std::int64_t first, std::int64_t last) {
    for (std::int64_t n = first; n < last; ++n) stamper_.word(code(n), start_ns(n));
  }
  std::string stamped(std::int64_t capture_ns) {
    FrameInfo info;
    info.capture_mono_ns = capture_ns;
    return stamper_.stamp(info) ? timecode_text(*info.timecode) : "none";
  }
  TimecodeStamper stamper_;
};

TEST_P(TimecodeStampers, AFrameGetsTheTimecodeItsMiddleLiesIn) {
  EXPECT_EQ(stamped(0), "none");
  tell(0, 1);
  EXPECT_EQ(stamped(start_ns(1)), "none") << "one word has no rate";
  tell(1, 200);
  const double period = 1e9 / GetParam();
  for (const std::int64_t n : {160, 199, 200, 203, 240}) {
    EXPECT_EQ(stamped(start_ns(n) + std::llround(.02 * period)), timecode_text(code(n)));
    EXPECT_EQ(stamped(start_ns(n) + std::llround(.98 * period)), timecode_text(code(n)));
  }
}

TEST_P(TimecodeStampers, ASilentSourceIsBelievedForTwoSeconds) {
  tell(0, 100);
  EXPECT_NE(stamped(start_ns(99) + TimecodeStamper::kBelievedNs - 1), "none");
  EXPECT_EQ(stamped(start_ns(99) + TimecodeStamper::kBelievedNs + 1), "none");
}

TEST_P(TimecodeStampers, LostWordsAndAClockThatIsSetAreFollowed) {
  tell(0, 50);
  tell(60, 61);
  EXPECT_EQ(stamped(start_ns(61) + 1'000'000), timecode_text(code(61)));
  stamper_.word({1, 2, 3, 4, false}, start_ns(70));
  EXPECT_EQ(stamped(start_ns(70) + 1'000'000), "01:02:03:04");
}

TEST_P(TimecodeStampers, JitterOfTheTimesMovesNoFrame) {
  for (std::int64_t n = 0; n < 100; ++n)
    stamper_.word(code(n), start_ns(n) + (n % 2 == 0 ? 50'000 : -50'000));
  EXPECT_EQ(stamped(start_ns(130) + std::llround(.5e9 / GetParam())), timecode_text(code(130)));
}

INSTANTIATE_TEST_SUITE_P(Rates, TimecodeStampers,
                         ::testing::Values(24000.0 / 1001, 24.0, 25.0, 30000.0 / 1001, 30.0));

TEST(TimecodeStamper, ATakeKeepsItsOwn) {
  TimecodeStamper stamper;
  for (std::uint8_t n = 0; n < 20; ++n) stamper.word({1, 0, 0, n, false}, n * 40'000'000LL);
  FrameInfo info;
  info.capture_mono_ns = 800'000'000;
  info.timecode = Timecode{9, 9, 9, 9, false};
  EXPECT_FALSE(stamper.stamp(info));
  EXPECT_EQ(timecode_text(*info.timecode), "09:09:09:09");
  info.timecode.reset();
  stamper.use(false);
  EXPECT_FALSE(stamper.stamp(info));
  stamper.use(true);
  EXPECT_TRUE(stamper.stamp(info));
  EXPECT_EQ(timecode_text(*info.timecode), "01:00:00:20");
}

}  // namespace
}  // namespace lightwell
