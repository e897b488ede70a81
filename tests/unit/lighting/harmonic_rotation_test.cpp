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

// As a shader does it: coefficients, rotation and sums in floats.
TEST(HarmonicRotation, InFloatsKeepsFiveDigits) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 50; ++i) {
    const Eigen::Matrix3d rotation = random_rotation(random);
    const HarmonicRotation turn(rotation, 8);
    Eigen::VectorXd light(harmonic_count(8)), y_here(light.size()), y_there(light.size());
    for (double& value : light) value = normal(random);
    light.normalize();
    Eigen::VectorXf turned(light.size());
    for (int l = 0; l <= 8; ++l)
      turned.segment(l * l, 2 * l + 1) =
          turn.band(l).cast<float>() * light.segment(l * l, 2 * l + 1).cast<float>();
    const Vec3d d = Vec3d(normal(random), normal(random), normal(random)).normalized();
    harmonics(d, 8, y_here.data());
    harmonics(rotation * d, 8, y_there.data());
    // Reconstruction after the turn is that before it; values are at most √(81/4π) for a light of norm 1.
    EXPECT_NEAR(y_there.cast<float>().dot(turned), y_here.dot(light), 1e-5);
  }
}

}  // namespace
}  // namespace lightwell
