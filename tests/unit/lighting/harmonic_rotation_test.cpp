// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/harmonic_rotation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

namespace lightwell {
namespace {

Eigen::Matrix3d random_rotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
  return q.normalized().toRotationMatrix();
}

TEST(HarmonicRotation, TurnsTheHarmonicsOfADirectionToThoseOfTheTurnedOne) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 20; ++i) {
    const Eigen::Matrix3d rotation = random_rotation(random);
    const HarmonicRotation turn(rotation, kMostDegree);
    const Vec3d d = Vec3d(normal(random), normal(random), normal(random)).normalized();
    Eigen::VectorXd here(harmonic_count(kMostDegree)), there(here.size());
    harmonics(d, kMostDegree, here.data());
    harmonics(rotation * d, kMostDegree, there.data());
    EXPECT_LT((turn.apply(here) - there).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(HarmonicRotation, IsOrthogonalAndComposes) {
  std::mt19937 random(2);
  const Eigen::Matrix3d a = random_rotation(random), b = random_rotation(random);
  const HarmonicRotation turn_a(a, 8), turn_b(b, 8), turn_ab(a * b, 8);
  for (int l = 0; l <= 8; ++l) {
    const Eigen::MatrixXd& band = turn_a.band(l);
    EXPECT_LT(
        (band * band.transpose() - Eigen::MatrixXd::Identity(2 * l + 1, 2 * l + 1)).cwiseAbs().maxCoeff(),
        1e-12);
    EXPECT_LT((band * turn_b.band(l) - turn_ab.band(l)).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(HarmonicRotation, ProjectionAndReconstructionAreOne) {
  // Radiance of degree 8, projected by its values and evaluated again: the rotation by nothing.
  const HarmonicRotation none(Eigen::Matrix3d::Identity(), 8);
  for (int l = 0; l <= 8; ++l)
    EXPECT_LT((none.band(l) - Eigen::MatrixXd::Identity(2 * l + 1, 2 * l + 1)).cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace lightwell
