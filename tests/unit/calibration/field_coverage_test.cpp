// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/lens/field_coverage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibration/lens/lens_report.h"
#include "tests/support/board_views.h"

namespace lightwell::calibration {
namespace {

TEST(FieldCoverage, CountsEveryPointThatCountsOnce) {
  const Lens truth{{1100, 1100}, {300, 300}, {600, 520}, {-0.05, 0.0013, -0.0028, 0.00025}, 100 * kPi / 180};
  test::BoardSetup setup;
  setup.field_rad = truth.max_theta_rad;
  setup.outliers = 0.03;
  const TargetViews views = test::board_views(truth, setup).target_views;
  const auto found = calibrate_lens(views);
  ASSERT_TRUE(found.ok());
  std::size_t counted = 0, points = 0;
  for (const auto& ring : field_coverage(*found, views).points)
    for (const std::size_t n : ring) counted += n;
  for (std::size_t v = 0; v < views.views.size(); ++v)
    points += views.views[v].points.size() - found->views[v].rejected.size();
  EXPECT_EQ(counted, points);
}

TEST(FieldCoverage, TheLastRingEndsWithTheField) {
  LensCalibration calibration;
  TargetViews none;
  const auto rings_to = [&](double deg) {
    calibration.lens.max_theta_rad = deg * kPi / 180;
    return field_coverage(calibration, none).points.size();
  };
  EXPECT_EQ(rings_to(3), 1u);
  EXPECT_EQ(rings_to(61.5), 6u);
  EXPECT_THAT(coverage_gaps(calibration, none),
              testing::EndsWith("50 to 61.5 degrees off axis: azimuth 0 to 360"));
  EXPECT_EQ(rings_to(66), 7u);
  EXPECT_THAT(coverage_gaps(calibration, none),
              testing::EndsWith("60 to 66 degrees off axis: azimuth 0 to 360"));
  EXPECT_EQ(rings_to(90), 9u);
}

TEST(Azimuth, GrowsFromTheTopOfTheImageToItsRight) {
  EXPECT_NEAR(azimuth_rad({0, -1, 1}), 0, 1e-12);
  EXPECT_NEAR(azimuth_rad({1, 0, 1}), kPi / 2, 1e-12);
  EXPECT_NEAR(azimuth_rad({0, 1, 1}), kPi, 1e-12);
  EXPECT_NEAR(azimuth_rad({-1, 0, 1}), 3 * kPi / 2, 1e-12);
}

}  // namespace
}  // namespace lightwell::calibration
