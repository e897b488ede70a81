// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/evaluation/evaluate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lighting/lat_long_image.h"
#include "tests/support/sampling_maps.h"

namespace lightwell {
namespace {

PolarMap random_map(const PolarGrid& grid, double range) {
  PolarMap map = PolarMap::make(grid, 3);
  std::mt19937 generator(4);
  std::uniform_real_distribution<double> exponent(0, range);
  for (float& value : map.radiance) value = static_cast<float>(std::pow(10.0, exponent(generator)));
  return map;
}

using test::every_bin_a_light;

// Walks along the ray from the point and looks whether it enters the sphere: no shared formula.
bool hidden_by_marching(const Vec3d& point, const Vec3d& direction) {
  double closest = 1e9;
  for (double t = 0; t < 8; t += 1e-4)
    closest = std::min(closest, (point + t * direction - Vec3d::UnitY()).norm());
  return closest < 1;
}

TEST(LightEvaluator, EveryBinAsALightHasNoError) {
  for (const PolarGrid& grid : {PolarGrid{9, 24, kPi / 2}, PolarGrid{13, 7, kPi}, PolarGrid{1, 1, kPi / 2}}) {
    const PolarMap map = random_map(grid, 8);
    const LightError error = LightEvaluator(map).error(every_bin_a_light(map));
    // Directions are floats: a cosine is off by 1e-7. No bin's centre is that close to a shadow edge on these
    // grids.
    EXPECT_LT(error.irradiance_rel_rmse, 1e-6);
    EXPECT_LT(error.shadow_rel_rmse, 1e-6);
  }
}

TEST(LightEvaluator, ReferenceEqualsABruteForceInDouble) {
  const PolarMap map = random_map({6, 10, kPi}, 4);
  const LightEvaluator evaluator(map);
  const auto normals = evaluation_normals();
  ASSERT_EQ(normals.size(), 642u);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    Rgbd sum = Rgbd::Zero();
    for (int ring = 0; ring < 6; ++ring)
      for (int sector = 0; sector < 10; ++sector) {
        const auto bin = static_cast<std::size_t>(ring * 10 + sector);
        sum += map.rgb(bin).cast<double>() * static_cast<double>(map.solid_angle_sr[bin]) *
               std::max(0.0, normals[i].dot(map.grid.bin_direction(ring, sector)));
      }
    // double rounding of running sums over 4 decades
    EXPECT_LT(((evaluator.map_irradiance()[i] - sum) / sum).abs().maxCoeff(), 1e-10);
  }
}

TEST(LightEvaluator, ShadowReferenceEqualsRaysMarchedIntoTheSphere) {
  const PolarMap map = random_map({5, 8, kPi}, 2);
  const LightEvaluator evaluator(map);
  const auto ground = evaluation_ground();
  ASSERT_EQ(ground.size(), 4096u);
  for (std::size_t i = 0; i < ground.size(); i += 97) {
    Rgbd sum = Rgbd::Zero();
    for (int ring = 0; ring < 5; ++ring)
      for (int sector = 0; sector < 8; ++sector) {
        const Vec3d direction = map.grid.bin_direction(ring, sector);
        if (direction.y() <= 1e-12 || hidden_by_marching(ground[i], direction)) continue;
        const auto bin = static_cast<std::size_t>(ring * 8 + sector);
        sum += map.rgb(bin).cast<double>() * static_cast<double>(map.solid_angle_sr[bin]) * direction.y();
      }
    EXPECT_LT((evaluator.map_shadow()[i] - sum).abs().maxCoeff(), 1e-9)
        << ground[i].transpose();  // double rounding
  }
}

TEST(LightEvaluator, UniformHemisphereIrradiatesANormalByItsTilt) {
  PolarMap map = PolarMap::make({180, 720, kPi / 2}, 1);
  for (float& value : map.radiance) value = 1;
  const auto normals = evaluation_normals();
  const LightEvaluator evaluator(map);
  for (std::size_t i = 0; i < normals.size();
       ++i)  // π (1 + cos tilt)/2; the midpoint rule at 0.5° is good to 1e-4
    EXPECT_NEAR(evaluator.map_irradiance()[i][1], kPi * (1 + normals[i].y()) / 2, 1e-4);
}

TEST(LightEvaluator, UniformSkyUnderTheSphereFollowsItsFormFactor) {
  PolarMap map = PolarMap::make({360, 720, kPi / 2}, 1);
  for (float& value : map.radiance) value = 1;
  LightSet ambient;
  ambient.ambient = Rgb::Constant(1);
  const auto exact = shadow_of_lights(ambient);
  const LightEvaluator evaluator(map);
  for (std::size_t i = 0; i < exact.size(); ++i)  // bins of 0.25° x 0.5° along the sphere's outline
    EXPECT_NEAR(evaluator.map_shadow()[i][0], exact[i][0], 5e-3);
  EXPECT_LT(evaluator.error(ambient).shadow_rel_rmse, 1e-3);
}

TEST(LightEvaluator, OneLightIsItsCosineAndItsShadow) {
  LightSet set;
  set.lights = {{Vec3f(0.6f, 0.8f, 0), {1, 2, 3}, -1, 0}};
  const auto irradiance = irradiance_of_lights(set);
  const auto normals = evaluation_normals();
  for (std::size_t i = 0; i < normals.size(); ++i)
    EXPECT_NEAR(irradiance[i][2], 3 * std::max(0.0, 0.6 * normals[i].x() + 0.8 * normals[i].y()),
                1e-6);  // floats
  // The shadow is the sphere projected along the light: an ellipse around (−0.75, 0) with half axes 1/0.8
  // and 1.
  const auto shadow = shadow_of_lights(set);
  const auto ground = evaluation_ground();
  for (std::size_t i = 0; i < ground.size(); ++i) {
    const double u = (ground[i].x() + 0.75) * 0.8;
    const double inside = u * u + ground[i].z() * ground[i].z();
    if (std::abs(inside - 1) < 1e-5) continue;  // float direction
    EXPECT_NEAR(shadow[i][0], inside < 1 ? 0 : 0.8, 1e-6);
  }
}

TEST(LightEvaluator, HalfThePowerIsHalfTheError) {
  const PolarMap map = random_map({9, 24, kPi / 2}, 3);
  LightSet set = every_bin_a_light(map);
  for (auto& light : set.lights) light.illuminance *= 0.5f;
  const LightError error = LightEvaluator(map).error(set);
  EXPECT_NEAR(error.irradiance_rel_rmse, 0.5, 1e-6);  // float directions
  EXPECT_NEAR(error.shadow_rel_rmse, 0.5, 1e-6);
}

TEST(LightEvaluator, BlackAgainstBlackIsNoErrorAndAgainstLightIsInfinite) {
  const PolarMap map = PolarMap::make({3, 4, kPi}, 3);
  LightSet set;
  EXPECT_EQ(LightEvaluator(map).error(set).shadow_rel_rmse, 0);
  set.lights = {{Vec3f::UnitY(), {1, 1, 1}, -1, 0}};
  EXPECT_TRUE(std::isinf(LightEvaluator(map).error(set).irradiance_rel_rmse));
}

TEST(LightEvaluator, ErrorsDoNotDependOnTheScaleOfTheLight) {
  PolarMap map = random_map({9, 24, kPi / 2}, 3);
  LightSet set = every_bin_a_light(map);
  set.lights.resize(100);
  const LightError error = LightEvaluator(map).error(set);
  for (const float scale : {1e-30f, 1e25f}) {
    PolarMap scaled = map;
    for (float& value : scaled.radiance) value *= scale;
    LightSet lights = set;
    for (auto& light : lights.lights) light.illuminance *= scale;
    EXPECT_NEAR(LightEvaluator(scaled).error(lights).irradiance_rel_rmse, error.irradiance_rel_rmse,
                1e-6);  // floats
    EXPECT_NEAR(LightEvaluator(scaled).error(lights).shadow_rel_rmse, error.shadow_rel_rmse, 1e-6);
  }
}

}  // namespace
}  // namespace lightwell
