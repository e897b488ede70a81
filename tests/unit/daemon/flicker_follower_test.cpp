// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/flicker_follower.h"

#include <gtest/gtest.h>

#include <utility>

namespace lightwell {
namespace {

constexpr std::int64_t kS = 1'000'000'000;

sync_photodiode lamp(double hz, double rate_hz, double exposure_us) {
  sync_photodiode seen{};
  seen.flags = SYNC_PHOTODIODE_ADVICE;
  seen.frequencies = hz > 0 ? 1 : 0;
  seen.frequency_mhz[0] = static_cast<std::uint32_t>(hz * 1e3 + .5);
  seen.depth_ppm[0] = 300'000;
  seen.rate_mhz = static_cast<std::uint32_t>(rate_hz * 1e3 + .5);
  seen.exposure_ns = static_cast<std::uint32_t>(exposure_us * 1e3 + .5);
  return seen;
}

class FlickerFollowers : public ::testing::Test {
 protected:
  FlickerFollower follower_{{25, 8000}};
};

TEST_F(FlickerFollowers, TakesTheAdviceAndKeepsItWhileTheLampIsThere) {
  const auto taken = follower_.consider(lamp(100, 25, 10000), 10 * kS);
  ASSERT_TRUE(taken);
  EXPECT_EQ(*taken, (TriggerChoice{25, 10000}));
  EXPECT_TRUE(follower_.follows());
  // The advice of then on starts from the new settings; whatever it says, the lamp is the same.
  for (int s = 11; s < 60; ++s)
    EXPECT_FALSE(follower_.consider(lamp(100.2, 24.5, 10000 - 10 * s), s * kS)) << s;
}

TEST_F(FlickerFollowers, GoesBackWhenTheLampGoes) {
  ASSERT_TRUE(follower_.consider(lamp(100, 24.39, 10000), 10 * kS));
  EXPECT_FALSE(follower_.consider(lamp(0, 24.39, 10000), 12 * kS)) << "said of the light before";
  const auto back = follower_.consider(lamp(0, 24.39, 10000), 16 * kS);
  ASSERT_TRUE(back);
  EXPECT_EQ(*back, (TriggerChoice{25, 8000}));
  EXPECT_FALSE(follower_.follows());
}

// Were the next advice taken from the settings that the last lamp led to, many lamps would lead far away.
TEST_F(FlickerFollowers, AnotherLampIsMetFromTheSettingsThatWereWanted) {
  ASSERT_TRUE(follower_.consider(lamp(100, 20, 10000), 10 * kS));
  const auto back = follower_.consider(lamp(120, 15, 8333), 20 * kS);
  ASSERT_TRUE(back);
  EXPECT_EQ(*back, (TriggerChoice{25, 8000}));
  const auto next = follower_.consider(lamp(120, 25, 8333), 30 * kS);
  ASSERT_TRUE(next);
  EXPECT_EQ(*next, (TriggerChoice{25, 8333}));
}

// Two lamps of one depth, one of which breathes: which is the deeper changes from measurement to measurement.
TEST_F(FlickerFollowers, LampsThatChangePlacesAreTheSameLamps) {
  sync_photodiode first = lamp(100, 24, 10000);
  first.frequencies = 2;
  first.frequency_mhz[1] = 120'010;
  first.depth_ppm[1] = 298'000;
  ASSERT_TRUE(follower_.consider(first, 10 * kS));
  sync_photodiode second = first;
  std::swap(second.frequency_mhz[0], second.frequency_mhz[1]);
  for (int s = 20; s < 600; s += 2)
    EXPECT_FALSE(follower_.consider(s % 4 == 0 ? first : second, s * kS)) << s;
  // One that outshines both is another light.
  sync_photodiode third = first;
  third.frequencies = 3;
  third.frequency_mhz[2] = 90'000;
  third.depth_ppm[2] = 290'000;
  EXPECT_FALSE(follower_.consider(third, 700 * kS));
  third.depth_ppm[2] = 600'000;
  EXPECT_TRUE(follower_.consider(third, 702 * kS));
  EXPECT_FALSE(follower_.follows());
}

TEST_F(FlickerFollowers, NoAdviceNoLampAClippedReadingOrNothingToGainChangeNothing) {
  sync_photodiode clipped = lamp(100, 24, 10000), silent = clipped;
  clipped.flags |= SYNC_PHOTODIODE_CLIPPED;
  silent.flags = 0;
  EXPECT_FALSE(follower_.consider(clipped, 10 * kS));
  EXPECT_FALSE(follower_.consider(silent, 10 * kS));
  EXPECT_FALSE(follower_.consider(lamp(0, 24, 10000), 10 * kS));
  EXPECT_FALSE(follower_.consider(lamp(100, 25.001, 8010), 10 * kS));
  EXPECT_FALSE(follower_.consider(lamp(100, 0, 0), 10 * kS));
  EXPECT_FALSE(follower_.follows());
}

}  // namespace
}  // namespace lightwell
