// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/phong_lobe.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "lighting/field/harmonic_rotation.h"

namespace lightwell {
namespace {

// ∫₀¹ t^s P_l(t) dt by the powers of the Legendre polynomial, in long double.
long double moment(double s, int l) {
  long double sum = 0;
  for (int k = 0; 2 * k <= l; ++k) {  // P_l = 2^−l Σ (−1)^k C(l, k) C(2l − 2k, l) t^(l − 2k)
    long double term = std::pow(-1.0L, k);
    for (int i = 1; i <= k; ++i) term *= static_cast<long double>(l - k + i) / i;
    for (int i = 1; i <= l; ++i) term *= static_cast<long double>(l - 2 * k + i) / i;
    sum += term / (s + l - 2 * k + 1);
  }
  return std::ldexp(sum, -l);
}

TEST(PhongLobe, MomentsAreTheIntegrals) {
  for (const double s : {0.0, 0.5, 1.0, 2.0, 6.0, 30.0, 1000.0}) {
    double moments[kMostDegree + 1];
    phong_moments(s, kMostDegree, moments);
    for (int l = 0; l <= kMostDegree; ++l)
      EXPECT_NEAR(moments[l], static_cast<double>(moment(s, l)), 1e-12) << s << " " << l;
  }
}

TEST(PhongLobe, OfExponentOneIsTheClampedCosine) {
  double lobe[harmonic_count(8)], y[harmonic_count(8)];
  const Vec3d axis = Vec3d(0.3, -0.8, 0.5).normalized();
  phong_lobe(axis, 1, 8, lobe);
  harmonics(axis, 8, y);
  for (int l = 0; l <= 8; ++l)
    for (int m = -l; m <= l; ++m)
      EXPECT_NEAR(lobe[harmonic_index(l, m)], irradiance_factor(l) * y[harmonic_index(l, m)], 1e-14);
}

TEST(PhongLobe, TurnedIsTheLobeOfTheTurnedAxis) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.234, Vec3d(1, 2, -3).normalized()).toRotationMatrix();
  Eigen::VectorXd zonal(harmonic_count(8)), expected(harmonic_count(8));
  phong_lobe(Vec3d::UnitY(), 5.5, 8, zonal.data());
  phong_lobe(turn * Vec3d::UnitY(), 5.5, 8, expected.data());
  EXPECT_LT((HarmonicRotation(turn, 8).apply(zonal) - expected).cwiseAbs().maxCoeff(), 1e-12);
  for (int l = 1; l <= 8; ++l)  // zonal: nothing beside m = 0
    for (int m = 1; m <= l; ++m) EXPECT_NEAR(zonal[harmonic_index(l, m)], 0, 1e-15);
}

TEST(PhongLobe, InFloatsIsTheLobeToFiveDigits) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  for (const double s : {0.0, 1.0, 6.0, 50.0})
    for (int i = 0; i < 20; ++i) {
      const Vec3d axis = Vec3d(normal(random), normal(random), normal(random)).normalized();
      const Vec3d at = Vec3d(normal(random), normal(random), normal(random)).normalized();
      double moments[kMostDegree + 1], exact[harmonic_count(8)], y_axis[harmonic_count(8)],
          y_at[harmonic_count(8)];
      phong_moments(s, 8, moments);
      phong_lobe(axis, s, 8, exact);
      harmonics(axis, 8, y_axis);
      harmonics(at, 8, y_at);
      float turned = 0;  // the zonal harmonics turned to the axis, and their sum, in floats
      double expected = 0;
      for (int l = 0; l <= 8; ++l)
        for (int m = -l; m <= l; ++m) {
          const int k = harmonic_index(l, m);
          turned += static_cast<float>(2 * kPi * moments[l]) * static_cast<float>(y_axis[k]) *
                    static_cast<float>(y_at[k]);
          expected += exact[k] * y_at[k];
        }
      EXPECT_NEAR(static_cast<double>(turned), expected, 1e-5) << s;  // of a lobe whose peak is 1
    }
}

TEST(PhongLobe, TruncationIsWhatTheSumLeavesOut) {
  EXPECT_NEAR(phong_truncation(6, 4), 0.14, 0.005);
  EXPECT_LT(phong_truncation(6, 8), phong_truncation(6, 4));
  // Against the sum over the sphere, about +Y: a ring is 2π dy.
  constexpr int kSteps = 20000;
  double lobe[harmonic_count(4)], y[harmonic_count(4)];
  phong_lobe(Vec3d::UnitY(), 3, 4, lobe);
  double error = 0, norm = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double t = 1 - (2 * i + 1.0) / kSteps;
    harmonics({0, t, std::sqrt(1 - t * t)}, 4, y);
    double sum = 0;
    for (int k = 0; k < harmonic_count(4); ++k) sum += lobe[k] * y[k];
    const double exact = std::pow(std::max(0.0, t), 3);
    error += (sum - exact) * (sum - exact);
    norm += exact * exact;
  }
  EXPECT_NEAR(phong_truncation(3, 4), std::sqrt(error / norm), 1e-6);
}

}  // namespace
}  // namespace lightwell
