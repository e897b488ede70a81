// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/light_set.h"

#include <gtest/gtest.h>

#include <random>

namespace lightwell {
namespace {

LightSet random_set(std::size_t count, bool parents) {
  LightSet set;
  std::mt19937 generator(1);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> uniform(0.0f, 2.0f);
  Rgb total = Rgb::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    DirectionalLight light;
    light.direction = Vec3f(normal(generator), normal(generator), normal(generator)).normalized();
    for (int c = 0; c < 3; ++c) light.illuminance[c] = uniform(generator);
    light.parent = i == 0 || !parents ? -1 : static_cast<std::int32_t>(generator() % i);
    total += light.illuminance;
    set.lights.push_back(light);
  }
  set.has_parents = parents;
  set.total_illuminance = total;
  return set;
}

Rgbd sum(const LightSet& set) {
  Rgbd total = Rgbd::Zero();
  for (const auto& light : set.lights) total += light.illuminance.cast<double>();
  return total;
}

TEST(TakeLights, KeepsThePowerPerChannelForEveryCount) {
  for (const bool parents : {false, true}) {
    const LightSet set = random_set(40, parents);
    for (std::size_t count = 1; count <= 41; ++count) {
      const LightSet taken = take_lights(set, count);
      EXPECT_EQ(taken.lights.size(), std::min<std::size_t>(count, 40));
      // float rounding of 40 lights
      EXPECT_LT(((sum(taken) - sum(set)) / sum(set)).abs().maxCoeff(), 1e-6) << count;
      for (const auto& light : taken.lights) EXPECT_NEAR(light.direction.norm(), 1.0f, 1e-6f);
    }
  }
}

TEST(TakeLights, FoldsChildrenIntoTheLuminanceWeightedMeanDirection) {
  LightSet set;
  set.has_parents = true;
  set.lights = {{Vec3f::UnitX(), Rgb::Constant(3), -1, 0},
                {Vec3f::UnitY(), Rgb::Constant(2), 0, 0},
                {Vec3f::UnitZ(), Rgb::Constant(2), 1, 0}};
  const LightSet one = take_lights(set, 1);
  EXPECT_TRUE(one.lights[0].direction.isApprox(Vec3f(3, 2, 2).normalized(), 1e-6f));
  const LightSet two = take_lights(set, 2);
  EXPECT_EQ(two.lights[0].direction, Vec3f(Vec3f::UnitX()));  // untouched: bit for bit
  EXPECT_TRUE(two.lights[1].direction.isApprox(Vec3f(0, 1, 1).normalized(), 1e-6f));
}

TEST(TakeLights, OppositeAndDarkLightsLeaveTheParentsDirection) {
  LightSet set;
  set.has_parents = true;
  set.lights = {{Vec3f::UnitX(), Rgb::Constant(1), -1, 0}, {-Vec3f::UnitX(), Rgb::Constant(1), 0, 0}};
  EXPECT_EQ(take_lights(set, 1).lights[0].direction, Vec3f(Vec3f::UnitX()));
  for (auto& light : set.lights) light.illuminance = Rgb::Zero();
  EXPECT_EQ(take_lights(set, 1).lights[0].direction, Vec3f(Vec3f::UnitX()));
}

TEST(TakeLights, AChannelThatIsDarkInThePrefixIsSpreadByLuminance) {
  LightSet set;
  set.lights = {{Vec3f::UnitX(), {3, 0, 0}, -1, 0},
                {Vec3f::UnitY(), {1, 0, 0}, -1, 0},
                {Vec3f::UnitZ(), {0, 8, 0}, -1, 0}};
  const LightSet two = take_lights(set, 2);
  EXPECT_FLOAT_EQ(two.lights[0].illuminance[1], 6);
  EXPECT_FLOAT_EQ(two.lights[1].illuminance[1], 2);
  EXPECT_FLOAT_EQ(two.lights[0].illuminance[0], 3);
}

TEST(TakeLights, NoneOfThemIsAnEmptySet) {
  EXPECT_TRUE(take_lights(random_set(4, true), 0).lights.empty());
}

}  // namespace
}  // namespace lightwell
