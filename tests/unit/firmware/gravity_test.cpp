// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/gravity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

namespace {

using Vector = std::array<double, 3>;
constexpr double kStandard = 9.80665;
constexpr double kDt = 1.0 / 208;  // a common rate of such sensors

// Rodrigues: v turned about axis (unit) by angle.
Vector turned(const Vector& v, const Vector& axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const double along = v[0] * axis[0] + v[1] * axis[1] + v[2] * axis[2];
  const Vector across = {axis[1] * v[2] - axis[2] * v[1], axis[2] * v[0] - axis[0] * v[2],
                         axis[0] * v[1] - axis[1] * v[0]};
  Vector out{};
  for (std::size_t i = 0; i < 3; ++i) out[i] = v[i] * c + across[i] * s + axis[i] * along * (1 - c);
  return out;
}

double degrees_between(const float* a, const Vector& b) {
  double dot = 0, aa = 0, bb = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    dot += static_cast<double>(a[i]) * b[i];
    aa += static_cast<double>(a[i]) * static_cast<double>(a[i]);
    bb += b[i] * b[i];
  }
  return std::acos(std::clamp(dot / std::sqrt(aa * bb), -1.0, 1.0)) * 180 / std::numbers::pi;
}

// A board in virtual time, with a sensor of a phone's grade: 0.02 m/s² and 0.002 rad/s of noise, a constant bias.
class Motion {
 public:
  explicit Motion(unsigned seed) : random_(seed) { gravity_init(&filter); }

  void step(const Vector& axis, double rate, const Vector& push = {}) {
    up = turned(up, axis, -rate * kDt);  // a vector fixed in the world turns backwards in the board's axes
    float acceleration[3], gyroscope[3];
    for (std::size_t i = 0; i < 3; ++i) {
      acceleration[i] = static_cast<float>(up[i] + push[i] + 0.02 * normal_(random_));
      gyroscope[i] = static_cast<float>(axis[i] * rate + bias[i] + 0.002 * normal_(random_));
    }
    gravity_sample(&filter, acceleration, gyroscope, static_cast<float>(kDt));
  }
  void rest(double seconds) {
    for (double t = 0; t < seconds; t += kDt) step({0, 0, 1}, 0);
  }

  gravity filter{};
  Vector up = {0, 0, kStandard};
  Vector bias = {0.01, -0.02, 0.015};

 private:
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
};

TEST(Gravity, AtRestItIsWhatTheAccelerometerReadsWithoutItsNoise) {
  Motion motion(1);
  motion.up = turned(motion.up, {0.6, 0.8, 0}, 0.7);
  motion.rest(5);
  EXPECT_TRUE(gravity_steady(&motion.filter));
  // 0.02 m/s² over 42 samples: 0.003 m/s², 0.02° rms.
  EXPECT_LT(degrees_between(motion.filter.up, motion.up), 0.1);
}

TEST(Gravity, TheGyroscopesBiasIsLearnedAtRest) {
  Motion motion(2);
  motion.rest(60);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(motion.filter.bias[i], motion.bias[i], 1e-3);
}

TEST(Gravity, TurnsAreFollowedAtOnce) {
  Motion motion(3);
  motion.rest(30);
  const Vector axis = {0.48, -0.64, 0.6};
  double worst = 0;
  for (double t = 0; t < 3; t += kDt) {  // to and fro, up to 3 rad/s
    motion.step(axis, 3 * std::sin(2 * std::numbers::pi * t));
    worst = std::max(worst, degrees_between(motion.filter.up, motion.up));
  }
  EXPECT_LT(worst,
            1.0);  // the accelerometer alone would be as good: this holds the gyroscope's sign and axes
  EXPECT_FALSE(gravity_steady(&motion.filter));
}

TEST(Gravity, PushesAndShakesDoNotPassForUp) {
  Motion motion(4);
  motion.rest(30);
  double worst = 0, alone = 0;
  for (double t = 0; t < 10; t += kDt) {  // carried about: 2 Hz, 5 m/s² sideways, and turning a little
    const double push = 5 * std::sin(4 * std::numbers::pi * t);
    motion.step({0, 1, 0}, 0.3 * std::cos(3 * t), {push, 0.3 * push, 0});
    worst = std::max(worst, degrees_between(motion.filter.up, motion.up));
    alone = std::max(alone, std::atan(std::abs(push) / kStandard) * 180 / std::numbers::pi);
  }
  EXPECT_GT(alone, 20);  // what the accelerometer alone would say
  EXPECT_LT(worst, 4);
}

TEST(Gravity, FreeFallAndNothingAtTheStartAreWaitedThrough) {
  gravity filter;
  gravity_init(&filter);
  const float nothing[3] = {0, 0, 0}, up[3] = {0, 9.8f, 0};
  for (int i = 0; i < 100; ++i) gravity_sample(&filter, nothing, nothing, 0.005f);
  EXPECT_FALSE(filter.started);
  gravity_sample(&filter, up, nothing, 0.005f);
  for (int i = 0; i < 100; ++i) gravity_sample(&filter, nothing, nothing, 0.005f);
  EXPECT_FLOAT_EQ(filter.up[1], 9.8f);
  EXPECT_FALSE(gravity_steady(&filter));
}

}  // namespace
