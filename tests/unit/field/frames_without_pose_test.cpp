// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "field/frames_without_pose.h"

#include <gtest/gtest.h>

namespace lightwell {
namespace {

constexpr std::int64_t kStart_ns = 77'000'000'000, kPeriod_ns = 100'000'000;

TEST(FramesWithoutPose, NeighboursAreOneTimeOfTheTake) {
  FramesWithoutPose frames;
  for (int i = 0; i < 10; ++i)
    frames.add(kStart_ns + i * kPeriod_ns, !(i == 2 || i == 3 || i == 6 || i >= 8));
  ASSERT_EQ(frames.spans().size(), 3u);
  EXPECT_EQ(frames.spans()[0].frames, 2u);
  EXPECT_EQ(frames.text(), "0.200 to 0.300 s (2 frames), 0.600 s (1 frame), 0.800 to 0.900 s (2 frames)");
}

TEST(FramesWithoutPose, OfManyTheLongestAreShownInTheirOrder) {
  FramesWithoutPose frames;
  int frame = 0;
  for (int span = 1; span <= 8; ++span) {
    for (int i = 0; i < span; ++i) frames.add(kStart_ns + frame++ * kPeriod_ns, false);
    frames.add(kStart_ns + frame++ * kPeriod_ns, true);
  }
  EXPECT_EQ(frames.spans().size(), 8u);
  EXPECT_TRUE(frames.text().starts_with("0.500 to 0.700 s (3 frames), 0.900 to 1.200 s (4 frames), "));
  EXPECT_TRUE(frames.text().ends_with("3.500 to 4.200 s (8 frames), and 2 shorter times"));
  EXPECT_EQ(FramesWithoutPose().text(), "");
}

}  // namespace
}  // namespace lightwell
