// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/quality_control.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace lightwell::render {
namespace {

// A machine without a clock: milliseconds of a frame, a light's shading, and its map's texels.
struct Machine {
  double fixed_ms, light_ms, texels_ms;
  [[nodiscard]] double ms(const Quality& q) const {
    return fixed_ms + q.lights * (light_ms + texels_ms * q.texels);
  }
};

double error(const Quality& q) {
  return std::hypot(0.9 * std::pow(q.lights, -0.8), 0.006 / std::sqrt(q.texels));
}

Quality run(QualityControl& control, const Machine& machine, double most, int frames,
            double every_tenth = 1) {
  Quality q;
  for (int i = 0; i < frames; ++i) {
    q = control.choose(most, error);
    control.frame_took(machine.ms(q) * (i % 10 == 3 ? every_tenth : 1));
  }
  return q;
}

TEST(QualityControl, BeginsWithFewLightsAndGoesOnlySmallSteps) {
  QualityControl control(25);
  Quality before = control.choose(1000, error);
  EXPECT_LE(before.lights, 16);
  for (int i = 0; i < 2000; ++i) {
    const Quality q = control.choose(1000, error);
    // A light at a time fades over three frames, of many lights a forty-eighth of them.
    EXPECT_LE(std::abs(q.lights - before.lights), std::max(1.0 / 3, before.lights / 48) * 1.01);
    EXPECT_LE(std::abs(q.texels - before.texels), before.texels / 48 * 1.01);
    before = q;
    control.frame_took(Machine{2, 0.05, 0.05}.ms(q));
  }
  EXPECT_GT(before.lights, 100);
}

TEST(QualityControl, KeepsTheFrameTimeOnMachinesOfAnySpeedThroughHiccups) {
  for (const double speed : {0.1, 1.0, 10.0}) {
    QualityControl control(25);
    const Machine machine{5 / speed, 0.5 / speed, 0.3 / speed};
    const Quality q = run(control, machine, 400, 3000, 20);
    EXPECT_LE(machine.ms(q), std::max(40.0, machine.ms({1, 1.0 / 16}))) << speed;
    EXPECT_TRUE(machine.ms(q) >= 0.7 * 40 || (q.lights == 400 && q.texels == 1) || q.lights == 1) << speed;
  }
}

TEST(QualityControl, FollowsAMachineThatGetsSlowerAndFasterAgain) {
  QualityControl control(25);
  const Machine fast{2, 0.1, 0.1}, slow{2, 1, 1};
  const Quality first = run(control, fast, 500, 2000);
  const Quality less = run(control, slow, 500, 2000);
  EXPECT_LE(slow.ms(less), 40);
  EXPECT_LT(less.lights, first.lights);
  const Quality again = run(control, fast, 500, 3000);
  EXPECT_GE(fast.ms(again), 0.7 * 40);
}

TEST(QualityControl, GivesUpWhatCostsTimeAndNotWhatIsFree) {
  QualityControl dear_texels(25), free_texels(25);
  const Quality of_dear = run(dear_texels, {2, 0.02, 1}, 200, 4000);
  const Quality of_free = run(free_texels, {2, 1, 0.001}, 200, 4000);
  EXPECT_LT(of_dear.texels, 0.5);
  EXPECT_GT(of_free.texels, 2 * of_dear.texels);
  EXPECT_GT(of_dear.lights, of_free.lights);
}

// Maps that stand take no time, however many texels they have: noise must not teach that they do.
TEST(QualityControl, LeavesTheTexelsOfMapsThatStand) {
  for (const double fps : {25.0, 40.0, 1000.0}) {
    QualityControl control(fps);
    const Machine machine{10, 2, 0};
    Quality q;
    for (int i = 0; i < 300; ++i) {
      q = control.choose(64, error);
      control.frame_took(machine.ms(q) * (1 + 0.05 * std::sin(7.0 * i)), i == 0 ? 1 : 0);
      if (i > 20) {
        EXPECT_EQ(q.texels, 1) << fps;
      }
    }
    EXPECT_TRUE(machine.ms(q) <= 1000 / fps || q.lights == 1) << fps << " " << q.lights;
  }
}

TEST(QualityControl, StaysWhereItIsOnceTheTimeFits) {
  QualityControl control(25);
  const Machine machine{5, 0.5, 0.3};
  const Quality there = run(control, machine, 400, 3000);
  for (int i = 0; i < 500; ++i) {
    const Quality q = control.choose(400, error);
    ASSERT_EQ(q.lights, there.lights);
    ASSERT_EQ(q.texels, there.texels);
    control.frame_took(machine.ms(q) * (1 + 0.02 * std::sin(i)));
  }
}

TEST(QualityControl, OutOfReachLeavesOneLightOfTheLeastTexels) {
  QualityControl control(1000);
  const Quality q = run(control, {50, 1, 1}, 100, 3000);
  EXPECT_EQ(q.lights, 1);
  EXPECT_EQ(q.texels, 1.0 / 16);
}

// Of a machine whose time goes with the logarithms, so that there is one right cost of each.
constexpr double kFixed_ms = 20, kLights_ms = 6, kTexels_ms = 3;
double logarithmic_ms(const Quality& q) {
  return kFixed_ms + kLights_ms * std::log(q.lights) + kTexels_ms * std::log(q.texels);
}
// Differences of times over logarithms of a forty-eighth or more: rounding.
constexpr double kRounding = 1e-9;

bool is_known(const std::array<double, QualityControl::kKnobs>& costs) {
  return std::abs(costs[0] - kLights_ms) < kRounding && std::abs(costs[1] - kTexels_ms) < kRounding;
}

TEST(QualityControl, LearnsWhatLightsAndTexelsCost) {
  for (const double fps : {14.0, 18.0, 22.0}) {
    QualityControl control(fps);
    for (int i = 0; i < 600; ++i) control.frame_took(logarithmic_ms(control.choose(4000, error)));
    EXPECT_TRUE(is_known(control.costs_ms()))
        << fps << ": " << control.costs_ms()[0] << ", " << control.costs_ms()[1];
  }
}

// In the midst of a step as well: what follows answers no step that was made.
TEST(QualityControl, FewerLightsToChooseFromTeachNothing) {
  int drops = 0;
  for (int frame = 0; frame < 600; ++frame) {
    QualityControl control(14);
    Quality q;
    for (int i = 0; i < frame; ++i) control.frame_took(logarithmic_ms(q = control.choose(4000, error)));
    if (!is_known(control.costs_ms())) continue;
    ++drops;
    for (int i = 0; i < 40; ++i)
      control.frame_took(logarithmic_ms(control.choose(std::floor(q.lights * 0.6), error)));
    ASSERT_TRUE(is_known(control.costs_ms()))
        << "frame " << frame << ": " << control.costs_ms()[0] << ", " << control.costs_ms()[1];
  }
  EXPECT_GT(drops, 300);
}

TEST(QualityControl, NeverTakesMoreLightsThanThereAre) {
  QualityControl control(25);
  run(control, {1, 0.01, 0.01}, 300, 2000);
  EXPECT_LE(control.choose(5, error).lights, 300);
  const Quality q = run(control, {1, 0.01, 0.01}, 5, 1000);
  EXPECT_EQ(q.lights, 5);
}

}  // namespace
}  // namespace lightwell::render
