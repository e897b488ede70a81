// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/error_kernel.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <vector>

#include "tests/support/directions.h"

namespace lightwell::test {
namespace {

TEST(LambertianMoments, GiveTheIrradianceOfEveryNormal) {
  // Σ moments(d) · Y(n) is the cosine's expansion to degree 4, which is within .06 of max(0, n·d) everywhere
  // (Ramamoorthi and Hanrahan 2001).
  const double factor[] = {kPi, 2 * kPi / 3, kPi / 4, -kPi / 24};
  std::vector<Vec3d> d = random_directions(200, 7);
  for (Vec3d& v : d) v.normalize();
  for (const Vec3d& a : d)
    for (const Vec3d& b : d) {
      const MomentVector m = lambertian_moments(a), n = lambertian_moments(b);
      double cosine = 0;
      for (int i = 0; i < 18; ++i) cosine += m[i] * n[i] / factor[i < 1 ? 0 : i < 4 ? 1 : i < 9 ? 2 : 3];
      const double c = a.dot(b), p2 = (3 * c * c - 1) / 2, p4 = (35 * c * c * c * c - 30 * c * c + 3) / 8;
      const double series =
          (kPi + 3 * (2 * kPi / 3) * c + 5 * (kPi / 4) * p2 + 9 * (-kPi / 24) * p4) / (4 * kPi);
      EXPECT_NEAR(cosine, series, 1e-12);  // the addition theorem: the 18 functions are a full basis
      EXPECT_NEAR(series, std::max(0.0, c), 0.06);
    }
}

TEST(ErrorKernel, IsTheSumOfItsParts) {
  for (const Vec3d& a : random_directions(50, 1))
    for (const Vec3d& b : random_directions(50, 2)) {
      const double share = kPlainShare + kGroundShare * ground_share(a.y()) * ground_share(b.y());
      const double distance = std::hypot((a - b).norm(), kSoftening_rad);
      const double moments = moment_weight() * lambertian_moments(a).dot(lambertian_moments(b));
      EXPECT_NEAR(error_kernel(a, b), share * (3 - distance) + moments,
                  1e-6);  // directions are unit to a float
    }
  EXPECT_NEAR(moment_weight() * lambertian_moments(Vec3d::UnitZ()).squaredNorm(), kIrradianceWeight, 1e-12);
}

TEST(ErrorKernel, IsPositiveDefinite) {
  const std::vector<Vec3d> d = random_directions(150, 3);
  Eigen::MatrixXd g(150, 150);
  for (int i = 0; i < 150; ++i)
    for (int j = 0; j < 150; ++j)
      g(i, j) = error_kernel(d[static_cast<std::size_t>(i)], d[static_cast<std::size_t>(j)]);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(g).eigenvalues().minCoeff(), 1e-6);
}

TEST(ErrorKernel, ItsMomentsSlopeIsTheDifferenceQuotient) {
  const MomentVector light = lambertian_moments(Vec3d(0.3, 0.8, -0.5).normalized());
  for (const Vec3d& d : random_directions(50, 4)) {
    const Vec3d slope = moment_gradient(d, light);
    for (int axis = 0; axis < 3; ++axis) {
      // The functions are polynomials in x, y, z: they have a slope off the sphere as well.
      const double h = 1e-5;
      const Vec3d step = h * Vec3d::Unit(axis);
      const double up = lambertian_moments(d + step).dot(light),
                   down = lambertian_moments(d - step).dot(light);
      EXPECT_NEAR(slope[axis], moment_weight() * (up - down) / (2 * h), 1e-8);  // h² and rounding / h
    }
  }
}

TEST(ErrorKernel, GroundShareHasItsSlope) {
  for (const double y : {-0.9, -0.3, 0.01, 0.2, 0.49, 0.51, 1.0}) {
    const double h = 1e-6;
    EXPECT_NEAR(ground_share_slope(y), (ground_share(y + h) - ground_share(y - h)) / (2 * h), 1e-9);
  }
  EXPECT_EQ(ground_share(0), 0);
  EXPECT_EQ(ground_share(-0.7), 1);
}

}  // namespace
}  // namespace lightwell::test
