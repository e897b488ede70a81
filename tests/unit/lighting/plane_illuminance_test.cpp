// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/plane_illuminance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace lightwell {
namespace {

TEST(PlaneIlluminance, UnderAnEvenSkyIsTheClosedForm) {
  PolarMap map = PolarMap::make({}, 3);
  const std::array<float, 3> sky = {100, 50, 25};
  for (int c = 0; c < 3; ++c)
    std::fill(map.plane(c).begin(), map.plane(c).end(), sky[static_cast<std::size_t>(c)]);
  // A plane that is tilted by t sees π (1 + cos t) / 2 of an even half sphere.
  for (const double tilt : {0.0, 0.4, 1.2}) {
    const Rgbd lux = plane_illuminance(map, Vec3d(0, std::cos(tilt), std::sin(tilt)));
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(lux[c] / (kPi * (1 + std::cos(tilt)) / 2 * sky[static_cast<std::size_t>(c)]), 1, 1e-3)
          << tilt;
  }
}

TEST(PlaneIlluminance, OfOneLampFollowsTheCosineAndEndsAtTheHorizon) {
  PolarMap map = PolarMap::make({}, 1);
  const std::size_t bin = 30 * 360 + 90;
  map.radiance[bin] = 1e8F;
  const Vec3d lamp = map.grid.bin_direction(30, 90);
  const double facing = 1e8 * map.solid_angle_sr[bin];
  EXPECT_NEAR(plane_illuminance(map, lamp)[0], facing, 1e-6 * facing);
  EXPECT_NEAR(plane_illuminance(map, Vec3d::UnitY())[1], facing * lamp.y(), 1e-6 * facing);
  EXPECT_EQ(plane_illuminance(map, -lamp)[2], 0);
}

}  // namespace
}  // namespace lightwell
