// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/timeline.h"

#include <gtest/gtest.h>

#include <random>

namespace {

constexpr std::uint32_t kHz = 84'000'000;

// base + (index + rest / parts) · hz · denominator / numerator in exact arithmetic, to the nearest tick.
std::uint64_t exact(std::uint64_t base, std::uint64_t index, std::uint32_t rest, std::uint32_t parts,
                    std::uint32_t numerator, std::uint32_t denominator) {
  using Wide = unsigned __int128;
  const Wide up = (static_cast<Wide>(index) * parts + rest) * kHz * denominator;
  const Wide down = static_cast<Wide>(parts) * numerator;
  return base + static_cast<std::uint64_t>((up + down / 2) / down);
}

TEST(Timeline, PartsOfASecondAreTheNearestTicksForEver) {
  std::mt19937_64 random(1);
  timeline line;
  timeline_init(&line, 1000, kHz, 1, 1);
  std::uint64_t index = 0;
  for (int i = 0; i < 20'000; ++i) {
    const auto parts = static_cast<std::uint32_t>(1 + random() % ((1u << 30) - 1));
    const auto rest = static_cast<std::uint32_t>(random() % parts);
    ASSERT_EQ(timeline_tick(&line, index, rest, parts), exact(1000, index, rest, parts, 1, 1));
    index += random() % 5;
    timeline_roll(&line, timeline_tick(&line, index, 0, 1));
    EXPECT_EQ(line.index, index);
  }
}

TEST(Timeline, PeriodsThatAreNoWholeTicksDriftByLessThanATickADay) {
  timeline line;
  timeline_init(&line, 0, kHz, 30000, 1001);
  const std::uint64_t day = 30ull * 86'400;
  timeline_roll(&line, exact(0, day, 1, 2, 30000, 1001));
  ASSERT_EQ(line.index, day);
  const auto off =
      static_cast<std::int64_t>(timeline_tick(&line, day, 0, 1) - exact(0, day, 0, 1, 30000, 1001));
  EXPECT_LE(std::abs(off), 1);  // 2.6 million edges of at most 2^-32 ticks, and rounding
}

TEST(Timeline, EdgesBeforeTheBaseAreWhereTheyWere) {
  timeline line, rolled;
  timeline_init(&line, 5'000'000, kHz, 24000, 1001);
  rolled = line;
  timeline_roll(&rolled, 5'000'000 + 40ull * kHz);
  for (std::uint64_t index = 0; index < 1000; ++index)
    for (const std::uint32_t rest : {0u, 3u, 6u})
      EXPECT_NEAR(static_cast<double>(timeline_tick(&rolled, index, rest, 7)),
                  static_cast<double>(timeline_tick(&line, index, rest, 7)),
                  1);  // 960 edges of 2^-32: rounding
}

TEST(Timeline, ShiftsCarryBothWays) {
  timeline line;
  timeline_init(&line, 100, kHz, 60, 1);
  timeline_shift_q32(&line, -1);
  EXPECT_EQ(line.base, 99u);
  EXPECT_EQ(line.base_part, 0xFFFFFFFFu);
  timeline_shift_q32(&line, 1);
  EXPECT_EQ(line.base, 100u);
  EXPECT_EQ(line.base_part, 0u);
  timeline_shift_q32(&line, (std::int64_t{7} << 32) + 5);
  EXPECT_EQ(line.base, 107u);
  EXPECT_EQ(line.base_part, 5u);
}

}  // namespace
