// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/pose_track.h"

#include <gtest/gtest.h>

namespace lightwell {
namespace {

constexpr std::int64_t kMs = 1'000'000;

TimedPose pose(std::int64_t time_ms, const Vec3d& at, double turn_rad = 0) {
  return {time_ms * kMs, {at, Eigen::Quaterniond(Eigen::AngleAxisd(turn_rad, Vec3d::UnitY()))}};
}

TEST(PoseTrack, PlacesLieOnLinesAndTurnsAreEven) {
  const PoseTrack track({pose(100, {0, 1, 2}), pose(140, {0.4, 1, 1.8}, 0.8)}, {});
  const auto at = track.at(110 * kMs, 0);
  ASSERT_EQ(at.known, PoseTrack::Known::yes);
  EXPECT_LE((at.pose.position_m - Vec3d(0.1, 1, 1.95)).norm(), 1e-12);
  const Eigen::AngleAxisd turn(at.pose.world_from_probe);
  EXPECT_NEAR(turn.angle(), 0.2, 1e-12);
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
  const PoseTrack track(
      {pose(100, {0, 0, 0}), pose(200, {0.1, 0, 0}), pose(301, {0.2, 0, 0}), pose(311, {0.5, 0, 0})}, {});
  const auto known = [&](std::int64_t ms) { return track.at(ms * kMs, 0).known; };
  EXPECT_EQ(known(99), Known::outside);
  EXPECT_EQ(known(100), Known::yes);
  EXPECT_EQ(known(150), Known::yes);
  EXPECT_EQ(known(200), Known::yes);
  EXPECT_EQ(known(250), Known::in_gap) << "101 ms";
  EXPECT_EQ(known(301), Known::yes) << "a pose itself is known";
  EXPECT_EQ(known(305), Known::in_jump) << "0.3 m in 10 ms";
  EXPECT_EQ(known(311), Known::yes);
  EXPECT_EQ(known(312), Known::outside);
  EXPECT_EQ(track.first_jump(), 3u);
  EXPECT_EQ(track.at(312 * kMs, -0.001).known, Known::yes) << "the lag moves the ends as well";
  const PoseTrack calm({pose(1, {0, 0, 0})}, {});
  EXPECT_EQ(calm.first_jump(), 1u);
  EXPECT_EQ(calm.at(1 * kMs, 0).known, Known::yes);
  EXPECT_EQ(calm.at(2 * kMs, 0).known, Known::outside);
}

}  // namespace
}  // namespace lightwell
