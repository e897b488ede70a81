// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "daemon/web/pictures.h"
#include "tests/support/fake_daemon.h"

namespace lightwell {
namespace {

TEST(FisheyePicture, PutsPlusZAtTheTopAndPlusXAtTheRight) {
  PolarMap map = PolarMap::make({.rings = 9, .sectors = 36}, 1);
  std::fill(map.radiance.begin(), map.radiance.end(), 1.0f);
  // Bright near the horizon around azimuth 90°, which is +X.
  for (int ring = 6; ring < 9; ++ring)
    for (int sector = 7; sector < 11; ++sector)
      map.radiance[static_cast<std::size_t>(ring * 36 + sector)] = 50.0f;
  const auto picture = fisheye_picture(map, 101);
  const auto value = [&](int x, int y) { return picture[static_cast<std::size_t>((y * 101 + x) * 3)]; };
  EXPECT_GT(value(93, 50), value(50, 7));
  EXPECT_GT(value(93, 50), value(7, 50));
  EXPECT_EQ(value(50, 7), value(50, 93));
  EXPECT_EQ(value(0, 0), 0) << "outside the circle";
}

TEST(FisheyePicture, AnyMapGivesAPicture) {
  for (const int channels : {1, 3})
    for (const float level : {0.0f, 1e-30f, 1.0f, 1e30f}) {
      PolarMap map = PolarMap::make({.rings = 1, .sectors = 1, .theta_max_rad = 1.7}, channels);
      std::fill(map.radiance.begin(), map.radiance.end(), level);
      EXPECT_EQ(fisheye_picture(map, 7).size(), 147u);
    }
}

}  // namespace
}  // namespace lightwell
