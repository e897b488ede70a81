// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/pose_track.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lightwell {
namespace {

constexpr std::int64_t kMs = 1'000'000;

TimedPose pose(std::int64_t time_ms, const Vec3d& at, double turn_rad = 0) {
  return {time_ms * kMs, {at, Eigen::Quaterniond(Eigen::AngleAxisd(turn_rad, Vec3d::UnitY()))}};
}

TEST(PoseTrack, PlacesLieOnLinesAndTurnsAreEven) {
  const PoseTrack track({pose(100, {0, 1, 2}), pose(140, {0.4, 1, 1.8}, 0.4)}, {});
  const auto at = track.at(110 * kMs, 0);
  ASSERT_EQ(at.known, PoseTrack::Known::yes);
  EXPECT_LE((at.pose.position_m - Vec3d(0.1, 1, 1.95)).norm(), 1e-12);
  const Eigen::AngleAxisd turn(at.pose.world_from_probe);
  EXPECT_NEAR(turn.angle(), 0.1, 1e-12);
  EXPECT_NEAR(turn.axis().y(), 1, 1e-12);
}

TEST(PoseTrack, AQuaternionAndItsNegativeAreOneTurn) {
  TimedPose other = pose(140, {0, 0, 0}, 0.4);
  other.pose.world_from_probe.coeffs() *= -1;
  const PoseTrack track({pose(100, {0, 0, 0}), other}, {});
  EXPECT_NEAR(Eigen::AngleAxisd(track.at(120 * kMs, 0).pose.world_from_probe).angle(), 0.2, 1e-12);
}

TEST(PoseTrack, PosesThatComeLateCarryLaterTimes) {
  // The probe is at x = t; its poses are stamped 30 ms late.
  std::vector<TimedPose> poses;
  for (int t = 0; t <= 1000; t += 10) poses.push_back(pose(t + 30, {t * 1e-3, 0, 0}));
  const PoseTrack track(poses, {});
  EXPECT_NEAR(track.at(500 * kMs, 0.03).pose.position_m.x(), 0.5, 1e-12);
  EXPECT_NEAR(track.at(500 * kMs, 0).pose.position_m.x(), 0.47, 1e-12);
}

TEST(PoseTrack, NothingIsKnownOutsideInGapsAndInJumps) {
  using Known = PoseTrack::Known;
  const PoseTrack track({pose(100, {0, 0, 0}), pose(200, {0.1, 0, 0}), pose(301, {0.2, 0, 0}),
                         pose(311, {0.5, 0, 0}), pose(312, {0.5, 0, 0})},
                        {});
  const auto known = [&](std::int64_t ms) { return track.at(ms * kMs, 0).known; };
  EXPECT_EQ(known(99), Known::outside);
  EXPECT_EQ(known(100), Known::yes);
  EXPECT_EQ(known(150), Known::yes);
  EXPECT_EQ(known(200), Known::yes);
  EXPECT_EQ(known(250), Known::in_gap) << "101 ms";
  EXPECT_EQ(known(301), Known::yes) << "a pose itself is known";
  EXPECT_EQ(known(305), Known::in_jump) << "0.3 m in 10 ms";
  EXPECT_EQ(known(311), Known::yes);
  EXPECT_EQ(known(313), Known::outside);
  ASSERT_TRUE(track.first_jump());
  EXPECT_EQ(track.first_jump()->from, 2u);
  EXPECT_EQ(track.first_jump()->to, 3u);
  EXPECT_NEAR(track.first_jump()->metres, 0.3, 1e-12);
  EXPECT_TRUE(track.outliers().empty());
  EXPECT_EQ(track.at(313 * kMs, -0.001).known, Known::yes) << "the lag moves the ends as well";
  const PoseTrack calm({pose(1, {0, 0, 0})}, {});
  EXPECT_FALSE(calm.first_jump());
  EXPECT_EQ(calm.at(1 * kMs, 0).known, Known::yes);
  EXPECT_EQ(calm.at(2 * kMs, 0).known, Known::outside);
}

// One metre a second along x, a pose each 10 ms from 0 to 1 s, the given ones moved by 5 m or turned by 2 rad.
std::vector<TimedPose> walk_with(const std::vector<int>& wrong, bool turned = false) {
  std::vector<TimedPose> poses;
  for (int i = 0; i <= 100; ++i) {
    const bool is_wrong = std::find(wrong.begin(), wrong.end(), i) != wrong.end();
    poses.push_back(pose(10 * i, {0.01 * i, is_wrong && !turned ? 5.0 : 0.0, 0}, is_wrong && turned ? 2 : 0));
  }
  return poses;
}

TEST(PoseTrack, AnOutlierAtTheTimeOfAFrameIsLeftOutAndThePathGoesOverIt) {
  for (const bool turned : {false, true})
    for (const std::vector<int>& wrong :
         {std::vector{50}, std::vector{50, 51, 52}, std::vector{20, 60, 61}}) {
      const PoseTrack track(walk_with(wrong, turned), {});
      EXPECT_EQ(track.outliers(), std::vector<std::size_t>(wrong.begin(), wrong.end()));
      EXPECT_FALSE(track.first_jump());
      for (int ms = 0; ms <= 1000; ms += 5) {
        const auto at = track.at(ms * kMs, 0);
        ASSERT_EQ(at.known, PoseTrack::Known::yes) << ms;
        EXPECT_LE((at.pose.position_m - Vec3d(ms * 1e-3, 0, 0)).norm(), 1e-12) << ms;
        EXPECT_LE(Eigen::AngleAxisd(at.pose.world_from_probe).angle(), 1e-12) << ms;
      }
    }
  const PoseTrack track(walk_with({50}), {});
  EXPECT_EQ(track.first_outlier()->from, 49u);
  EXPECT_EQ(track.first_outlier()->to, 50u);
  EXPECT_NEAR(track.first_outlier()->metres, 5, 1e-4);
}

TEST(PoseTrack, AnOutlierAtAnEndCountsForNothing) {
  const PoseTrack track(walk_with({0, 100}), {});
  EXPECT_EQ(track.outliers(), (std::vector<std::size_t>{0, 100}));
  EXPECT_EQ(track.at(0, 0).known, PoseTrack::Known::in_jump);
  EXPECT_EQ(track.at(5 * kMs, 0).known, PoseTrack::Known::in_jump);
  EXPECT_EQ(track.at(10 * kMs, 0).known, PoseTrack::Known::yes);
  EXPECT_EQ(track.at(995 * kMs, 0).known, PoseTrack::Known::in_jump);
  EXPECT_EQ(track.first_outlier()->to, 1u) << "the step from it";
}

TEST(PoseTrack, OfTwoPathsInTurnNeitherIsBelieved) {
  std::vector<int> odd;
  for (int i = 1; i <= 100; i += 2) odd.push_back(i);
  const PoseTrack track(walk_with(odd), {});
  EXPECT_EQ(track.outliers().size(), 101u);
  for (int ms = 0; ms <= 1000; ms += 5) EXPECT_EQ(track.at(ms * kMs, 0).known, PoseTrack::Known::in_jump);
}

TEST(PoseTrack, WhatLastsIsAJumpAndNoOutlier) {
  std::vector<int> wrong;  // 0.3 s elsewhere: longer than a gap that may be passed
  for (int i = 40; i < 70; ++i) wrong.push_back(i);
  const PoseTrack track(walk_with(wrong), {});
  EXPECT_TRUE(track.outliers().empty());
  EXPECT_EQ(track.at(395 * kMs, 0).known, PoseTrack::Known::in_jump);
  EXPECT_EQ(track.at(405 * kMs, 0).known, PoseTrack::Known::yes);
  EXPECT_EQ(track.first_jump()->to, 40u);
}

TEST(PoseTrack, NoiseAndTimesThatLieCloseAreNoJumps) {
  // Each second pose arrives a tenth of a millisecond after the one before it, 1 m/s, a centimetre of noise.
  std::vector<TimedPose> poses;
  for (int i = 0; i < 100; ++i)
    poses.push_back({10 * kMs * (i / 2 * 2) + i % 2 * kMs / 10,
                     {{0.01 * i + 0.004 * (i % 3 - 1), 0, 0}, Eigen::Quaterniond::Identity()}});
  const PoseTrack track(poses, {});
  EXPECT_TRUE(track.outliers().empty());
  EXPECT_FALSE(track.first_jump());
}

}  // namespace
}  // namespace lightwell
