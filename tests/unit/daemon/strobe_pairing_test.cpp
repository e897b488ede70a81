// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/strobe_pairing.h"

#include <gtest/gtest.h>

#include <random>

namespace lightwell {
namespace {

constexpr std::int64_t kPeriod = 40'000'000;

TEST(StrobePairing, AnExposureBelongsToTheTriggerBeforeIt) {
  StrobePairing pairing(kPeriod);
  pairing.trigger(7, 1'000);
  EXPECT_FALSE(pairing.edge(true, 31'000));
  const auto exposure = pairing.edge(false, 4'031'000);
  ASSERT_TRUE(exposure);
  EXPECT_EQ(exposure->trigger, 7U);
  EXPECT_EQ(exposure->begin_mono_ns, 31'000);
  EXPECT_EQ(exposure->end_mono_ns, 4'031'000);
  EXPECT_EQ(pairing.strobes(), 1U);
}

TEST(StrobePairing, EdgesMayBeReadAfterLaterTriggersWereMade) {
  StrobePairing pairing(kPeriod);
  for (std::uint32_t n = 0; n < 10; ++n) pairing.trigger(n, n * kPeriod);
  for (std::uint32_t n = 0; n < 10; ++n) {
    EXPECT_FALSE(pairing.edge(true, n * kPeriod + 100));
    const auto exposure = pairing.edge(false, n * kPeriod + 200);
    ASSERT_TRUE(exposure);
    EXPECT_EQ(exposure->trigger, n);
  }
}

TEST(StrobePairing, WhatAnswersNoTriggerIsAStray) {
  StrobePairing pairing(kPeriod);
  EXPECT_FALSE(pairing.edge(true, 5));  // before any
  EXPECT_FALSE(pairing.edge(false, 6));
  pairing.trigger(0, 10);
  EXPECT_FALSE(pairing.edge(true, 10 + kPeriod));  // too late
  EXPECT_FALSE(pairing.edge(false, 20 + kPeriod));
  EXPECT_EQ(pairing.strays(), 2U);
  pairing.trigger(1, 2 * kPeriod);
  EXPECT_FALSE(pairing.edge(true, 2 * kPeriod + 5));
  EXPECT_TRUE(pairing.edge(false, 2 * kPeriod + 9));
  EXPECT_FALSE(pairing.edge(true, 2 * kPeriod + 12)) << "a second answer to one trigger";
  EXPECT_FALSE(pairing.edge(false, 2 * kPeriod + 15));
  EXPECT_EQ(pairing.strays(), 3U);
  EXPECT_EQ(pairing.strobes(), 1U);
}

TEST(StrobePairing, AnExposureWhoseEndWasNotSeenIsLeftOut) {
  StrobePairing pairing(kPeriod);
  pairing.trigger(0, 0);
  EXPECT_FALSE(pairing.edge(true, 5));
  pairing.trigger(1, kPeriod);
  EXPECT_FALSE(pairing.edge(true, kPeriod + 5));
  const auto exposure = pairing.edge(false, kPeriod + 9);
  ASSERT_TRUE(exposure);
  EXPECT_EQ(exposure->trigger, 1U);
  pairing.trigger(2, 2 * kPeriod);
  EXPECT_FALSE(pairing.edge(true, 2 * kPeriod + 5));
  EXPECT_FALSE(pairing.edge(false, 3 * kPeriod + 6)) << "longer than the window";
}

// Edges lost at random: every exposure that is told is the camera's own for that trigger.
TEST(StrobePairing, NoExposureIsGivenToAnotherTrigger) {
  std::mt19937 random(1);
  std::bernoulli_distribution lost(0.1);
  StrobePairing pairing(kPeriod);
  constexpr std::uint32_t kTriggers = 100'000;
  std::uint32_t told = 0, seen = 0, answered = 0;
  for (std::uint32_t n = 0; n < kTriggers; ++n) {
    const std::int64_t at = std::int64_t{n} * kPeriod;
    const bool camera = !lost(random), rise = camera && !lost(random), fall = camera && !lost(random);
    pairing.trigger(n, at);
    if (rise) {
      EXPECT_FALSE(pairing.edge(true, at + 30'000));
    }
    const auto exposure = fall ? pairing.edge(false, at + 4'030'000) : std::nullopt;
    answered += rise ? 1 : 0;
    seen += rise && fall ? 1 : 0;
    if (!exposure) continue;
    ++told;
    ASSERT_EQ(exposure->trigger, n);
    ASSERT_EQ(exposure->begin_mono_ns, at + 30'000);
  }
  EXPECT_EQ(told, seen);
  EXPECT_EQ(pairing.strays(), 0U);
  // Those still remembered may be answered yet.
  EXPECT_LE(pairing.unanswered(), kTriggers - answered);
  EXPECT_GE(pairing.unanswered() + StrobePairing::kRemembered, kTriggers - answered);
}

}  // namespace
}  // namespace lightwell
