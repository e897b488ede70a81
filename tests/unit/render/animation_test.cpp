// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/animation.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "lighting/vector.h"

namespace lightwell::render {
namespace {

std::vector<float> at(const Track& track, double time_s) {
  std::vector<float> value(track.width);
  sample(track, time_s, value);
  return value;
}

Track numbers(Interpolation interpolation, std::vector<float> times_s, std::vector<float> values) {
  return {0, Track::Property::weights, interpolation, std::move(times_s), 1, std::move(values)};
}

TEST(Track, StepHoldsAKeyUntilTheNext) {
  const Track t = numbers(Interpolation::step, {1, 2, 4}, {10, 20, 40});
  EXPECT_EQ(at(t, 1.999)[0], 10);
  EXPECT_EQ(at(t, 2)[0], 20);
  EXPECT_EQ(at(t, 3.999)[0], 20);
}

TEST(Track, LinearIsTheStraightLineBetweenKeys) {
  const Track t = numbers(Interpolation::linear, {1, 2, 4}, {10, 20, 40});
  EXPECT_FLOAT_EQ(at(t, 1.25)[0], 12.5f);
  EXPECT_FLOAT_EQ(at(t, 3)[0], 30);
  EXPECT_EQ(at(t, 2)[0], 20);
}

TEST(Track, BeforeTheFirstKeyAndAfterTheLastItIsTheirs) {
  for (const auto interpolation : {Interpolation::step, Interpolation::linear}) {
    const Track t = numbers(interpolation, {1, 2}, {10, 20});
    EXPECT_EQ(at(t, -5)[0], 10);
    EXPECT_EQ(at(t, 0.5)[0], 10);
    EXPECT_EQ(at(t, 7)[0], 20);
  }
  const Track cubic = numbers(Interpolation::cubic_spline, {1, 2}, {9, 10, 9, 9, 20, 9});
  EXPECT_EQ(at(cubic, 0)[0], 10);
  EXPECT_EQ(at(cubic, 3)[0], 20);
  const Track one = numbers(Interpolation::linear, {1}, {10});
  for (const double time_s : {0.0, 1.0, 2.0}) EXPECT_EQ(at(one, time_s)[0], 10);
}

// A cubic through its own values and slopes is that cubic: x³ − 2x² + 3 on keys at 0, 2 and 5.
TEST(Track, CubicSplineReturnsTheCubicItsTangentsAreOf) {
  const auto f = [](double x) { return x * x * x - 2 * x * x + 3; };
  const auto slope = [](double x) { return 3 * x * x - 4 * x; };
  std::vector<float> values;
  for (const double x : {0.0, 2.0, 5.0})
    for (const double v : {slope(x), f(x), slope(x)}) values.push_back(static_cast<float>(v));
  const Track t = numbers(Interpolation::cubic_spline, {0, 2, 5}, values);
  // Single precision of values up to 78.
  for (double x = 0; x <= 5; x += 0.37) EXPECT_NEAR(at(t, x)[0], f(x), 1e-5 * 78);
}

Track turns(Interpolation interpolation, const std::vector<std::pair<Vec3d, double>>& keys, double sign = 1) {
  Track t{0, Track::Property::rotation, interpolation, {}, 4, {}};
  for (const auto& [axis, angle] : keys) {
    t.times_s.push_back(static_cast<float>(t.times_s.size()));
    const double own = t.times_s.size() % 2 == 0 ? sign : 1;
    const Vec3d v = axis * (own * std::sin(angle / 2));
    for (const double x : {v.x(), v.y(), v.z(), own * std::cos(angle / 2)})
      t.values.push_back(static_cast<float>(x));
  }
  return t;
}

TEST(Track, LinearRotationsTurnEvenlyTheShorterWay) {
  const Vec3d axis = Vec3d(1, 2, -2) / 3;
  // A quaternion and its negative are one turn.
  for (const double sign : {1.0, -1.0}) {
    const Track t = turns(Interpolation::linear, {{axis, 0.4}, {axis, 2.9}}, sign);
    for (const double x : {0.0, 0.1, 0.5, 0.75, 1.0}) {
      const double angle = 0.4 + x * 2.5;
      const auto q = at(t, x);
      const double same =
          q[3] * std::cos(angle / 2) + axis.dot(Vec3d(q[0], q[1], q[2])) * std::sin(angle / 2);
      EXPECT_NEAR(std::abs(same), 1, 1e-6) << x;
    }
  }
}

TEST(Track, EqualAndOppositeRotationsStayUnitQuaternions) {
  for (const double angle : {0.0, 1e-9, 2 * kPi}) {
    const Track t = turns(Interpolation::linear, {{Vec3d::UnitX(), 0}, {Vec3d::UnitX(), angle}});
    const auto q = at(t, 0.5);
    EXPECT_NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1, 1e-6) << angle;
  }
  Track opposite{0, Track::Property::rotation, Interpolation::cubic_spline, {0, 1}, 4, {}};
  for (const float sign : {1.0f, -1.0f})
    for (const float x : {0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, sign, 0.0f, 0.0f, 0.0f, 0.0f})
      opposite.values.push_back(x);
  const auto q = at(opposite, 0.5);
  EXPECT_EQ(q, (std::vector<float>{0, 0, 0, 1}));
}

TEST(Looped, BeginsAgainAtItsEnd) {
  EXPECT_DOUBLE_EQ(looped(7.5, 2), 1.5);
  EXPECT_DOUBLE_EQ(looped(2, 2), 0);
  EXPECT_DOUBLE_EQ(looped(-0.5, 2), 1.5);
  EXPECT_EQ(looped(3, 0), 0);
}

}  // namespace
}  // namespace lightwell::render
