// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/fit/nonnegative_least_squares.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace lightwell {
namespace {

struct Problem {
  Eigen::MatrixXd a;
  Eigen::VectorXd y;
};

Problem random_problem(int unknowns, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Problem p{Eigen::MatrixXd(40, unknowns), Eigen::VectorXd(40)};
  for (double& v : p.a.reshaped()) v = normal(random) + 0.5;
  for (double& v : p.y) v = normal(random) + 0.3;
  return p;
}

NonnegativeSolution solve(const Problem& p, unsigned guess = 0) {
  return solve_nonnegative(p.a.transpose() * p.a, p.a.transpose() * p.y, guess);
}

TEST(NonnegativeLeastSquares, MeetsTheConditionsOfOptimality) {
  for (unsigned seed = 0; seed < 50; ++seed)
    for (const int unknowns : {1, 2, 5, 11, 17}) {
      const Problem p = random_problem(unknowns, seed);
      const auto s = solve(p);
      const Eigen::VectorXd slope = p.a.transpose() * (p.y - p.a * s.x);
      for (int j = 0; j < unknowns; ++j) {
        EXPECT_GE(s.x[j], 0);
        // A hundred roundings of products of size 40.
        if (s.x[j] > 0)
          EXPECT_NEAR(slope[j], 0, 1e-11);
        else
          EXPECT_LE(slope[j], 1e-11);
      }
      EXPECT_NEAR(p.y.squaredNorm() - 2 * s.decrease, (p.y - p.a * s.x).squaredNorm(), 1e-11);
    }
}

TEST(NonnegativeLeastSquares, EqualsTheBestOfAllSubsets) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Problem p = random_problem(5, seed + 100);
    double best = p.y.squaredNorm();
    for (unsigned subset = 1; subset < 32; ++subset) {
      Eigen::MatrixXd columns(40, 0);
      for (int j = 0; j < 5; ++j)
        if ((subset >> j & 1u) != 0) {
          columns.conservativeResize(Eigen::NoChange, columns.cols() + 1);
          columns.rightCols(1) = p.a.col(j);
        }
      const Eigen::VectorXd x = columns.colPivHouseholderQr().solve(p.y);
      if ((x.array() >= 0).all()) best = std::min(best, (p.y - columns * x).squaredNorm());
    }
    EXPECT_NEAR((p.y - p.a * solve(p).x).squaredNorm(), best, 1e-10);
  }
}

TEST(NonnegativeLeastSquares, AGuessChangesTheWayNotTheEnd) {
  const Problem p = random_problem(8, 7);
  const auto plain = solve(p);
  for (const unsigned guess : {1u, 0x55u, 0xffu, plain.positive})
    EXPECT_LT((solve(p, guess).x - plain.x).cwiseAbs().maxCoeff(), 1e-12) << guess;
}

TEST(NonnegativeLeastSquares, ADependentColumnStaysAtZero) {
  Problem p = random_problem(3, 9);
  p.a = p.a.cwiseAbs();
  p.a.col(2) = p.a.col(0);
  p.y = p.a * Eigen::Vector3d(1, 2, 3);
  const auto s = solve(p);
  EXPECT_EQ((s.x.array() > 0).count(), 2);
  EXPECT_LT((p.a * s.x - p.y).norm(), 1e-10 * p.y.norm());
}

TEST(NonnegativeLeastSquares, NothingToFitGivesZero) {
  Problem p = random_problem(4, 11);
  p.y.setZero();
  EXPECT_EQ(solve(p).x.norm(), 0);
  p.y = -p.a.cwiseAbs().rowwise().sum();
  p.a = p.a.cwiseAbs();
  EXPECT_EQ(solve(p).x.norm(), 0);
}

}  // namespace
}  // namespace lightwell
