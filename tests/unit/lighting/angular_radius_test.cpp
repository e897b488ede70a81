// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/angular_radius.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lighting/decomposition/best_lights.h"
#include "lighting/decomposition/decompose.h"
#include "tests/support/decomposition_maps.h"

namespace lightwell {
namespace {

using test::kDegree;

constexpr PolarGrid kGrid{180, 720, kPi / 2};  // half a degree

PolarMap disc(const Vec3d& centre, double radius_rad, const Rgb& radiance, const Rgb& around) {
  PolarMap map = test::constant_map(kGrid, around);
  for (int ring = 0; ring < kGrid.rings; ++ring)
    for (int sector = 0; sector < kGrid.sectors; ++sector)
      if (kGrid.bin_direction(ring, sector).dot(centre) > std::cos(radius_rad))
        test::set_bin(map, ring, sector, radiance);
  return map;
}

DirectionalLight toward(const Vec3d& direction) {
  return {.direction = direction.cast<float>(), .illuminance = Rgb::Ones()};
}

const Vec3d kPlace = direction_from_spherical({50 * kDegree, 20 * kDegree});

TEST(AngularRadius, OfAnEvenDiscIsItsRadius) {
  for (const double degrees : {3.0, 8.0, 20.0}) {
    const PolarMap map = disc(kPlace, degrees * kDegree, Rgb(5, 6, 7), Rgb::Zero());
    std::vector<DirectionalLight> lights = {toward(kPlace)};
    set_angular_radii(map, lights);
    // The edge runs through bins of half a degree; a chord is shorter than its arc by θ²/24.
    EXPECT_NEAR(static_cast<double>(lights[0].angular_radius_rad), degrees * kDegree,
                0.02 * degrees * kDegree);
  }
}

TEST(AngularRadius, OfASunIsNotThatOfTheSkyAroundIt) {
  // 1 % of the light is sky: by its light alone the cell would be wider than 5 degrees.
  const PolarMap map = disc(kPlace, 1.5 * kDegree, Rgb::Constant(2e5f), Rgb::Constant(0.65f));
  std::vector<DirectionalLight> lights = {toward(kPlace)};
  set_angular_radii(map, lights);
  EXPECT_NEAR(static_cast<double>(lights[0].angular_radius_rad), 1.5 * kDegree, 0.1 * kDegree);
}

TEST(AngularRadius, DoesNotDependOnTheMapsScaleNorOnLightsWithoutPower) {
  const PolarMap map = test::outdoor({90, 360, kPi / 2});
  std::vector<DirectionalLight> lights = {toward(kPlace), toward(Vec3d::UnitY()), toward(Vec3d::UnitZ())};
  set_angular_radii(map, lights);
  std::vector<DirectionalLight> again = lights;
  again.push_back({.direction = kPlace.cast<float>(), .illuminance = Rgb::Zero(), .angular_radius_rad = 7});
  set_angular_radii(test::scaled(map, 1e6f), again);
  for (std::size_t i = 0; i < lights.size(); ++i)
    EXPECT_NEAR(again[i].angular_radius_rad, lights[i].angular_radius_rad,
                1e-5f);  // float rounding of the scale
  EXPECT_EQ(again[3].angular_radius_rad, 0);
}

TEST(AngularRadius, OfABlackMapIsNone) {
  std::vector<DirectionalLight> lights = {toward(kPlace)};
  set_angular_radii(test::constant_map(kGrid, Rgb::Zero()), lights);
  EXPECT_EQ(lights[0].angular_radius_rad, 0);
}

TEST(AngularRadius, OfManyLightsOfAnEvenSkyFillsIt) {
  const PolarMap map = test::constant_map({90, 360, kPi / 2}, Rgb::Ones());
  const auto set = decompose(map, Method::best, 64);
  ASSERT_TRUE(set.ok());
  double solid_angle = 0;
  for (const DirectionalLight& light : set->lights)
    solid_angle += kPi * std::pow(static_cast<double>(light.angular_radius_rad), 2);
  // Cells are no discs: their second moment is larger than that of a disc of their solid angle, a hexagon's by 1 %.
  EXPECT_GT(solid_angle, 2 * kPi);
  EXPECT_LT(solid_angle, 1.15 * 2 * kPi);
}

// The frame path takes it from atoms and eases it; the map by itself is taken bin by bin.
TEST(AngularRadius, OfAFrameIsThatOfTheMapWithinWhatAtomsResolve) {
  const PolarMap map = test::outdoor({90, 360, kPi / 2});
  BestLights lights(map.grid, 64);
  std::vector<DirectionalLight> live;
  for (int frame = 0; frame < 30; ++frame) {
    const auto out = lights.process(map);
    live.assign(out.begin(), out.end());
  }
  std::vector<DirectionalLight> exact = live;
  set_angular_radii(map, exact);
  double difference = 0, sum = 0;
  for (std::size_t i = 0; i < live.size(); ++i) {
    difference += std::abs(static_cast<double>(live[i].angular_radius_rad - exact[i].angular_radius_rad));
    sum += static_cast<double>(exact[i].angular_radius_rad);
  }
  EXPECT_LT(difference, 0.1 * sum);  // atoms are 3 to 12 degrees wide, cells 20
}

// A lamp of one bin in an even sky goes to another place, without a cut: its light there has its size from the first frame.
TEST(AngularRadius, OfALightAtANewPlaceIsThatOfThePlaceAtOnce) {
  const PolarGrid grid{90, 360, kPi / 2};
  for (const int count : {64, 256}) {
    BestLights lights(grid, count);
    int arrived = 0;
    for (int frame = 0; frame < 40; ++frame) {
      const int sector = frame < 20 ? 40 : 220;
      PolarMap map = test::constant_map(grid, Rgb::Ones());
      test::set_bin(map, 45, sector, Rgb::Constant(600));
      const auto out = lights.process(map);
      const Vec3f lamp = grid.bin_direction(45, sector).cast<float>();
      for (const DirectionalLight& light : out) {
        if (light.direction.dot(lamp) < std::cos(0.001f) || frame < 20) continue;
        ++arrived;
        std::vector<DirectionalLight> exact(out.begin(), out.end());
        set_angular_radii(map, exact);
        const auto at = static_cast<std::size_t>(&light - out.data());
        // A tenth, and what a cell has of sky beside its lamp while its bounds are those of atoms.
        EXPECT_NEAR(light.angular_radius_rad, exact[at].angular_radius_rad,
                    0.1f * exact[at].angular_radius_rad + 0.004f)
            << count << " lights, frame " << frame;
      }
    }
    EXPECT_GT(arrived, 10) << count;
  }
}

TEST(AngularRadius, OfAMapThatStandsStillComesToRest) {
  const PolarMap map = test::outdoor({90, 360, kPi / 2});
  for (const int count : {8, 64, 200}) {
    BestLights lights(map.grid, count);
    std::vector<DirectionalLight> before;
    for (int frame = 0; frame < 80; ++frame) {
      const auto out = lights.process(map);
      const std::vector<DirectionalLight> now(out.begin(), out.end());
      for (const DirectionalLight& a : before)
        for (const DirectionalLight& b : now) {
          if (a.id != b.id || frame < 70) continue;
          // .8⁷⁰ of any first difference; exchanges that still go on beside it move cells a little.
          EXPECT_NEAR(a.angular_radius_rad, b.angular_radius_rad, 1e-3f) << count;
        }
      before = now;
    }
  }
}

TEST(AngularRadius, OfPointsThatAreFoldedIsAsWideAsTheyAreApart) {
  LightSet set;
  set.has_parents = true;
  const auto at = [](double degrees, std::int32_t parent, float radius) {
    return DirectionalLight{.direction = direction_from_spherical({degrees * kDegree, 0}).cast<float>(),
                            .illuminance = Rgb::Ones(),
                            .parent = parent,
                            .angular_radius_rad = radius};
  };
  set.lights = {at(40, -1, 0), at(50, 0, 0)};
  // Two points at ±5°, each a disc of 1°: a second moment of 5² + 1/2 is that of a disc of √51°.
  EXPECT_NEAR(take_lights(set, 1).lights[0].angular_radius_rad, std::sqrt(51.0) * kDegree, 1e-4);
  set.lights = {at(40, -1, 0.1f), at(40, 0, 0.1f)};
  EXPECT_NEAR(take_lights(set, 1).lights[0].angular_radius_rad, 0.1f, 1e-6f);
  // What is bright counts: the light between a sun and a wide one is as wide as the sun is off it, √2 · 4°.
  set.lights = {at(40, -1, 0.005f), at(48, 0, 0.2f)};
  EXPECT_LT(take_lights(set, 1).lights[0].angular_radius_rad, 0.11f);
  EXPECT_EQ(take_lights(set, 2).lights[1].angular_radius_rad, 0.2f);
}

}  // namespace
}  // namespace lightwell
