// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/light_budget.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace lightwell::render {
namespace {

// A chain: every light is part of the first. Predictions fall as 0.4 / n.
LightSet chain(std::size_t count, bool predicted = true) {
  LightSet set;
  set.has_parents = true;
  for (std::size_t i = 0; i < count; ++i) {
    DirectionalLight light;
    light.direction = Vec3f(std::sin(0.1f * static_cast<float>(i)), 1, 0).normalized();
    light.illuminance = Rgb::Constant(10);
    light.parent = i == 0 ? -1 : 0;
    light.predicted_error = predicted ? 0.4f / static_cast<float>(i + 1) : 0;
    set.lights.push_back(light);
    set.total_illuminance += light.illuminance;
  }
  return set;
}

TEST(LightBudget, WithoutAGoalTheSetIsTakenAsItIs) {
  LightBudget budget({});
  const LightSet all = chain(72);
  EXPECT_EQ(&budget.choose(all), &all);
  budget.frame_took(1e6, 1);
  EXPECT_EQ(&budget.choose(all), &all);
}

// Frames that cost 5 ms and 0.5 ms a light.
TEST(LightBudget, HoldsTheFrameRateWithAsManyLightsAsItAffordsAndNeverJumps) {
  LightBudget budget({30.0, {}});
  const LightSet all = chain(200);
  std::size_t before = 16;  // what any machine affords
  for (int frame = 0; frame < 1500; ++frame) {
    const std::size_t n = budget.choose(all).lights.size();
    EXPECT_LE(n > before ? n - before : before - n, std::max<std::size_t>(1, before / 16));
    before = n;
    budget.frame_took(frame % 10 == 0 ? 500 : 5 + 0.5 * static_cast<double>(n), 1);  // a hiccup now and then
  }
  const double ms = 5 + 0.5 * static_cast<double>(before);
  EXPECT_LE(ms, 1000 / 30.0);
  EXPECT_GE(ms, 0.7 * 1000 / 30.0);
  for (int frame = 0; frame < 1500; ++frame) {  // another machine: ten times as fast
    before = budget.choose(all).lights.size();
    budget.frame_took(0.5 + 0.05 * static_cast<double>(before), 1);
  }
  EXPECT_EQ(before, 200u);
}

TEST(LightBudget, OneSlowFrameTakesNoLight) {
  LightBudget budget({30.0, {}});
  const LightSet all = chain(40);
  for (int frame = 0; frame < 500; ++frame) {
    static_cast<void>(budget.choose(all));
    budget.frame_took(1, 1);
  }
  for (int frame = 0; frame < 40; ++frame) {
    EXPECT_EQ(budget.choose(all).lights.size(), 40u) << frame;
    budget.frame_took(frame % 7 == 0 ? 900 : 28, 1);  // of 33 ms, the first one too
  }
}

TEST(LightBudget, AnErrorIsExpectedOfWhatIsChosen) {
  LightBudget budget({30.0, {}});
  const LightSet all = chain(100);
  static_cast<void>(budget.choose(all));
  const double at_first = budget.expected_error();
  EXPECT_GE(at_first, 0.4 / 16);  // of the lights alone
  for (int frame = 0; frame < 1000; ++frame) {
    static_cast<void>(budget.choose(all));
    budget.frame_took(1, 1);
  }
  EXPECT_EQ(budget.texels(), 1);
  EXPECT_NEAR(budget.expected_error(), std::hypot(0.4 / 100, 0.006), 1e-6);
  EXPECT_LT(budget.expected_error(), at_first);
}

TEST(LightBudget, DarkFramesChangeNothingAndLackNoPrediction) {
  LightBudget budget({{}, 0.031});
  const LightSet all = chain(72);
  LightSet dark = chain(72, false);
  for (DirectionalLight& light : dark.lights) light.illuminance = Rgb::Zero();
  const std::size_t before = budget.choose(all).lights.size();
  static_cast<void>(budget.choose(dark));
  EXPECT_FALSE(budget.lacks_prediction());
  EXPECT_EQ(budget.choose(all).lights.size(), before);
}

TEST(LightBudget, AFrameRateOutOfReachLeavesOneLight) {
  LightBudget budget({1000.0, {}});
  const LightSet all = chain(20);
  for (int frame = 0; frame < 1000; ++frame) {
    EXPECT_GE(budget.choose(all).lights.size(), 1u);
    budget.frame_took(50, 1);
  }
  EXPECT_EQ(budget.choose(all).lights.size(), 1u);
  EXPECT_LT((budget.chosen().lights[0].illuminance - all.total_illuminance).abs().maxCoeff(), 1e-3f);
}

TEST(LightBudget, TakesTheFewestLightsThatKeepThePredictedError) {
  for (const double error : {0.5, 0.11, 0.031, 0.0061, 1e-6}) {
    LightBudget budget({{}, error});
    const LightSet all = chain(72);
    const LightSet& chosen = budget.choose(all);
    const auto fewest = static_cast<std::size_t>(std::clamp(std::ceil(0.4 / error - 1e-6), 1.0, 72.0));
    EXPECT_EQ(chosen.lights.size(), fewest);
    EXPECT_EQ(chosen.lights.back().predicted_error, all.lights[fewest - 1].predicted_error);
  }
}

TEST(LightBudget, AnErrorThatHoversIsNoReasonToChangeTheNumber) {
  LightBudget budget({{}, 0.01});
  int changes = 0;
  std::size_t before = 0;
  for (int frame = 0; frame < 100; ++frame) {
    LightSet all = chain(72);
    for (DirectionalLight& light : all.lights)
      light.predicted_error *= 1 + 0.03f * std::sin(2.0f * static_cast<float>(frame));
    const std::size_t n = budget.choose(all).lights.size();
    EXPECT_LE(static_cast<double>(all.lights[n - 1].predicted_error), 0.01);
    if (frame > 10 && n != before) ++changes;
    before = n;
  }
  EXPECT_LE(changes, 2);
}

TEST(LightBudget, LightsWithoutPredictionAreAllTakenAndItIsSaid) {
  LightBudget budget({{}, 0.1});
  const LightSet all = chain(72, false);
  EXPECT_EQ(budget.choose(all).lights.size(), 72u);
  EXPECT_TRUE(budget.lacks_prediction());
  EXPECT_TRUE(budget.choose(LightSet{}).lights.empty());
}

}  // namespace
}  // namespace lightwell::render
