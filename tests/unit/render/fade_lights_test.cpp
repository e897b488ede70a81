// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/fade_lights.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lightwell::render {
namespace {

LightSet some_lights(std::size_t count, bool parents) {
  LightSet set;
  set.has_parents = parents;
  for (std::size_t i = 0; i < count; ++i) {
    DirectionalLight light;
    const auto x = static_cast<float>(i);
    light.direction = Vec3f(std::sin(1.3f * x), 1, std::cos(0.7f * x)).normalized();
    light.illuminance = Rgb(1 + x, 2, 3 / (1 + x));
    light.parent = i == 0 || !parents ? -1 : static_cast<std::int32_t>(i / 2);
    if (light.parent == static_cast<std::int32_t>(i)) light.parent = 0;
    set.lights.push_back(light);
  }
  return set;
}

// What a surface that faces up, and one that faces sideways, gets.
Eigen::Array2d seen(const LightSet& set) {
  Eigen::Array2d sum = Eigen::Array2d::Zero();
  for (const DirectionalLight& light : set.lights) {
    sum[0] += static_cast<double>(light.illuminance[0] * std::max(0.0f, light.direction.y()));
    sum[1] += static_cast<double>(light.illuminance[0] * std::max(0.0f, light.direction.x()));
  }
  return sum;
}

TEST(FadeLights, AtWholeNumbersTheyAreTheLightsTaken) {
  for (const bool parents : {false, true}) {
    const LightSet set = some_lights(20, parents);
    for (const std::size_t n : {1u, 7u, 20u, 30u}) {
      const LightSet faded = fade_lights(set, static_cast<double>(n));
      const LightSet taken = take_lights(set, n);
      ASSERT_EQ(faded.lights.size(), taken.lights.size());
      EXPECT_TRUE((seen(faded) == seen(taken)).all());
    }
  }
}

TEST(FadeLights, NoPowerIsLostAndNothingJumps) {
  for (const bool parents : {false, true}) {
    const LightSet set = some_lights(20, parents);
    Rgb power = Rgb::Zero();
    for (const DirectionalLight& light : set.lights) power += light.illuminance;
    Eigen::Array2d before = seen(fade_lights(set, 1));
    double whole_steps = 0;
    for (std::size_t n = 1; n < 20; ++n)
      whole_steps =
          std::max(whole_steps, (seen(take_lights(set, n + 1)) - seen(take_lights(set, n))).abs().maxCoeff());
    for (double count = 1; count <= 20; count += 1.0 / 32) {
      const LightSet faded = fade_lights(set, count);
      Rgb sum = Rgb::Zero();
      for (const DirectionalLight& light : faded.lights) {
        sum += light.illuminance;
        EXPECT_NEAR(light.direction.norm(), 1, 1e-5);
      }
      EXPECT_LT(((sum - power) / power).abs().maxCoeff(), 1e-4f);  // single precision
      // A thirty-second of a step, four times as much where directions turn under way.
      EXPECT_LE((seen(faded) - before).abs().maxCoeff(), whole_steps / 8 + 1e-4);
      before = seen(faded);
    }
  }
}

}  // namespace
}  // namespace lightwell::render
