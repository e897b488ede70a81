// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/harmonics.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <vector>

#include "lighting/direction.h"

namespace lightwell {
namespace {

Vec3d random_unit(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Vec3d(normal(random), normal(random), normal(random)).normalized();
}

TEST(Harmonics, AreOrthonormal) {
  constexpr int kCount = harmonic_count(kMostDegree);
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(kCount, kCount);
  // Equal steps of azimuth are exact for these orders; of the height's polynomial the midpoint rule with 4000 steps is
  // exact to the square of half a step, times a degree of 20.
  constexpr int kRings = 4000, kSectors = 32;
  Eigen::VectorXd values(kCount);
  for (int r = 0; r < kRings; ++r) {
    const double y = 1 - (2 * r + 1.0) / kRings;
    const double h = std::sqrt(1 - y * y);
    for (int s = 0; s < kSectors; ++s) {
      const double lambda = 2 * kPi * s / kSectors;
      harmonics({h * std::sin(lambda), y, h * std::cos(lambda)}, kMostDegree, values.data());
      products += values * values.transpose() * (4 * kPi / (kRings * kSectors));
    }
  }
  EXPECT_LT((products - Eigen::MatrixXd::Identity(kCount, kCount)).cwiseAbs().maxCoeff(), 2e-4);
}

TEST(Harmonics, HaveTheSignsAndAxesOfTheConvention) {
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) {
    const Vec3d d = random_unit(random);
    std::array<double, harmonic_count(2)> v;
    harmonics(d, 2, v.data());
    const double x = d.x(), y = d.y(), z = d.z();
    EXPECT_NEAR(v[0], std::sqrt(1 / (4 * kPi)), 1e-15);
    EXPECT_NEAR(v[1], std::sqrt(3 / (4 * kPi)) * x, 1e-15);  // m = −1: sin λ
    EXPECT_NEAR(v[2], std::sqrt(3 / (4 * kPi)) * y, 1e-15);
    EXPECT_NEAR(v[3], std::sqrt(3 / (4 * kPi)) * z, 1e-15);  // m = 1: cos λ
    EXPECT_NEAR(v[4], std::sqrt(15 / (4 * kPi)) * z * x, 1e-15);
    EXPECT_NEAR(v[5], std::sqrt(15 / (4 * kPi)) * y * x, 1e-15);
    EXPECT_NEAR(v[6], std::sqrt(5 / (16 * kPi)) * (3 * y * y - 1), 1e-15);
    EXPECT_NEAR(v[7], std::sqrt(15 / (4 * kPi)) * y * z, 1e-15);
    EXPECT_NEAR(v[8], std::sqrt(15 / (16 * kPi)) * (z * z - x * x), 1e-15);
  }
}

TEST(Harmonics, SumOfSquaresOfABandIsTheSameEverywhere) {
  std::mt19937 random(2);
  std::array<double, harmonic_count(kMostDegree)> v;
  for (int i = 0; i < 20; ++i) {
    harmonics(random_unit(random), kMostDegree, v.data());
    for (int l = 0; l <= kMostDegree; ++l) {
      double sum = 0;
      for (int m = -l; m <= l; ++m) {
        const double value = v[static_cast<std::size_t>(harmonic_index(l, m))];
        sum += value * value;
      }
      EXPECT_NEAR(sum, (2 * l + 1) / (4 * kPi), 1e-12);  // the addition theorem
    }
  }
}

TEST(Harmonics, SlopesAreTheDifferencesOfValues) {
  std::mt19937 random(3);
  std::array<double, harmonic_count(kMostDegree)> slope, other, before, after;
  for (int i = 0; i < 20; ++i) {
    const Vec3d d = random_unit(random);
    const Vec3d t = d.cross(random_unit(random)).normalized();
    harmonic_slopes(d, {t, d.cross(t)}, kMostDegree, {slope.data(), other.data()});
    constexpr double kStep = 1e-5;
    harmonics((d - kStep * t).normalized(), kMostDegree, before.data());
    harmonics((d + kStep * t).normalized(), kMostDegree, after.data());
    std::array<double, harmonic_count(kMostDegree)> of_other, unused;
    harmonic_slopes(d, {d.cross(t), t}, kMostDegree, {of_other.data(), unused.data()});
    EXPECT_EQ(of_other, other);
    for (std::size_t k = 0; k < slope.size(); ++k)
      // Third derivatives of degree 10 are below 1e4, times a sixth of the step squared; and rounding over the step.
      EXPECT_NEAR(slope[k], (after[k] - before[k]) / (2 * kStep), 1e-6);
  }
}

TEST(Harmonics, IrradianceFactorsAreThoseOfTheClampedCosine) {
  EXPECT_DOUBLE_EQ(irradiance_factor(0), kPi);
  EXPECT_DOUBLE_EQ(irradiance_factor(1), 2 * kPi / 3);
  EXPECT_DOUBLE_EQ(irradiance_factor(2), kPi / 4);
  EXPECT_EQ(irradiance_factor(3), 0);
  EXPECT_DOUBLE_EQ(irradiance_factor(4), -kPi / 24);
  EXPECT_EQ(irradiance_factor(7), 0);
  // A_l = 2π ∫ P_l(t) t dt over 0 to 1, by the midpoint rule.
  for (const int l : {6, 8, 10}) {
    double sum = 0;
    constexpr int kSteps = 100000;
    for (int i = 0; i < kSteps; ++i) {
      const double t = (i + 0.5) / kSteps;
      sum += 2 * kPi * std::legendre(static_cast<unsigned>(l), t) * t / kSteps;
    }
    EXPECT_NEAR(irradiance_factor(l), sum, 1e-8) << l;  // a step squared, times a curvature of 1e2
  }
}

}  // namespace
}  // namespace lightwell
