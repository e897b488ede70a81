// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/trigger.h"

#include <gtest/gtest.h>

#include <random>

namespace {

constexpr std::uint32_t kHz = 84'000'000;

struct Rate {
  std::uint32_t numerator, denominator;
};

class TriggerRates : public testing::TestWithParam<Rate> {};

TEST_P(TriggerRates, EveryTriggerIsTheNearestTickOfTheExactRateForHours) {
  const auto [numerator, denominator] = GetParam();
  timeline own;
  timeline_init(&own, 777, kHz, 1, 1);
  std::uint64_t step;
  std::uint32_t parts;
  ASSERT_TRUE(trigger_ratio(numerator, denominator, 1, 1, &step, &parts));
  trigger self{};
  const auto period = static_cast<std::uint32_t>(std::uint64_t{kHz} * denominator / numerator);
  trigger_start(&self, &own, step, parts, period, 0, 777);
  for (std::uint64_t k = 0; k < 300'000; ++k) {
    using Wide = unsigned __int128;
    const Wide up = static_cast<Wide>(k) * kHz * denominator;
    ASSERT_EQ(self.next, 777 + static_cast<std::uint64_t>((up + numerator / 2) / numerator)) << k;
    ASSERT_EQ(self.phase_error, 0);
    ASSERT_EQ(self.n, k);
    timeline_roll(&own, self.next);
    trigger_fired(&self, &own);
  }
}

INSTANTIATE_TEST_SUITE_P(Rates, TriggerRates,
                         testing::Values(Rate{24000, 1001}, Rate{24, 1}, Rate{25, 1}, Rate{30000, 1001},
                                         Rate{60000, 1001}, Rate{60, 1}, Rate{1, 1}, Rate{1000, 1},
                                         Rate{49985, 1000}, Rate{999983, 9973}));

TEST(Trigger, ARatioBeyondThirtyBitsIsRefusedAndOneThatReducesIsNot) {
  std::uint64_t step;
  std::uint32_t parts;
  EXPECT_FALSE(trigger_ratio(999'983, 9'973, 999'979, 9'967, &step, &parts));
  EXPECT_TRUE(trigger_ratio(24000, 1001, 30000, 1001, &step, &parts));
  EXPECT_EQ(step, 5u);
  EXPECT_EQ(parts, 4u);
}

TEST(Trigger, StartsAtTheFirstPlaceNotBeforeTheEarliest) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 2000; ++i) {
    timeline own;
    timeline_init(&own, 1000, kHz, 1, 1);
    std::uint64_t step;
    std::uint32_t parts;
    ASSERT_TRUE(trigger_ratio(60, 1, 1, 1, &step, &parts));
    const std::uint64_t earliest = 1000 + random() % (5ull * kHz);
    timeline_roll(&own, earliest);
    trigger self{};
    trigger_start(&self, &own, step, parts, kHz / 60, 0, earliest);
    EXPECT_GE(self.next, earliest);
    EXPECT_LT(self.next, earliest + kHz / 60);
    EXPECT_EQ((self.next - 1000) % (kHz / 60), 0u);
  }
}

TEST(Trigger, LateOnesAreLeftOutAndCountedAndTheRateStays) {
  timeline own;
  timeline_init(&own, 0, kHz, 1, 1);
  std::uint64_t step;
  std::uint32_t parts;
  ASSERT_TRUE(trigger_ratio(60, 1, 1, 1, &step, &parts));
  trigger self{};
  trigger_start(&self, &own, step, parts, kHz / 60, 0, 1000);
  const std::uint64_t first = self.next;
  EXPECT_FALSE(trigger_skip(&self, &own, first));
  EXPECT_TRUE(trigger_skip(&self, &own, first + 10 * kHz / 60 + 1));
  EXPECT_EQ(self.late, 11u);
  EXPECT_EQ(self.n, 0u);  // numbers are those of pulses sent
  EXPECT_EQ(self.next, first + 11 * (kHz / 60));
}

// From any phase to any other line: never more than a sixteenth off a period, there within ten triggers, then exact.
TEST(Trigger, MovesToAnotherLineBySlewing) {
  std::mt19937_64 random(2);
  for (int trial = 0; trial < 500; ++trial) {
    timeline own, other;
    timeline_init(&own, 0, kHz, 1, 1);
    timeline_init(&other, random() % kHz, kHz, 25, 1);
    std::uint64_t step;
    std::uint32_t parts;
    ASSERT_TRUE(trigger_ratio(50, 1, 1, 1, &step, &parts));
    const std::uint32_t period = kHz / 50;
    trigger self{};
    trigger_start(&self, &own, step, parts, period, 0, kHz);
    timeline_roll(&other, self.next);
    ASSERT_TRUE(trigger_ratio(50, 1, 25, 1, &step, &parts));
    std::uint64_t before = self.next - period;
    trigger_move(&self, &other, step, parts);
    for (int i = 0; i < 10; ++i) {
      const auto change = static_cast<std::int64_t>(self.next - before - period);
      ASSERT_LE(std::abs(change), period / 16);
      before = self.next;
      timeline_roll(&other, self.next);
      trigger_fired(&self, &other);
    }
    EXPECT_EQ(self.phase_error, 0);
    EXPECT_EQ((self.next - other.base) % period, 0u);
  }
}

}  // namespace
