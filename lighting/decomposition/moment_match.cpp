// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/moment_match.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace lightwell {
namespace {

constexpr int kMoments = 18;
constexpr int kPasses = 2;         // the change is relative, so the second pass corrects what clamping left
constexpr double kSoftness = 0.1;  // of a light's share 1/N: weighs change of powers against missed moments
constexpr double kLeastFactor = 0.25;  // a pass changes no light by more
constexpr double kMostFactor = 4;

}  // namespace

Eigen::MatrixXd lambertian_moments(const Directions& directions) {
  Eigen::MatrixXd m(kMoments, directions.cols());
  const double a0 = kPi * std::sqrt(1 / (4 * kPi));
  const double a1 = 2 * kPi / 3 * std::sqrt(3 / (4 * kPi));
  const double a2 = kPi / 4 * std::sqrt(15 / (4 * kPi));
  const double a4 = -kPi / 24 * 0.75 * std::sqrt(1 / kPi);
  const double s5 = std::sqrt(5.0), s35 = std::sqrt(35.0), r2 = std::sqrt(2.0);
  for (Eigen::Index i = 0; i < directions.cols(); ++i) {
    // Polar axis +Y, azimuth from +Z toward +X: (x, y, z) of the textbook are our (z, x, y).
    const double x = directions(2, i), y = directions(0, i), z = directions(1, i);
    const double xx = x * x, yy = y * y, zz = z * z;
    m.col(i) << a0,                                                                                        //
        a1 * y, a1 * z, a1 * x,                                                                            //
        a2 * x * y, a2 * y * z, a2 / (2 * std::sqrt(3.0)) * (3 * zz - 1), a2 * x * z, a2 / 2 * (xx - yy),  //
        a4 * s35 * x * y * (xx - yy), a4 * s35 / r2 * y * z * (3 * xx - yy), a4 * s5 * x * y * (7 * zz - 1),
        a4 * s5 / r2 * y * z * (7 * zz - 3), a4 / 4 * (35 * zz * zz - 30 * zz + 3),
        a4 * s5 / r2 * x * z * (7 * zz - 3), a4 * s5 / 2 * (xx - yy) * (7 * zz - 1),
        a4 * s35 / r2 * x * z * (xx - 3 * yy), a4 * s35 / 4 * (xx * (xx - 3 * yy) - yy * (3 * xx - yy));
  }
  return m;
}

void match_moments(const Directions& directions, const Eigen::MatrixXd& target,
                   Eigen::Matrix<double, Eigen::Dynamic, 3>& power) {
  const Eigen::MatrixXd moments = lambertian_moments(directions);
  const auto count = static_cast<double>(directions.cols());
  for (int pass = 0; pass < kPasses; ++pass)
    for (int c = 0; c < 3; ++c) {
      const double total = power.col(c).sum();
      if (!(total > 0)) continue;
      const Eigen::VectorXd missing = (target.col(c) - moments * power.col(c)) / total;
      Eigen::MatrixXd normal = moments * (power.col(c) / total).asDiagonal() * moments.transpose();
      normal.diagonal().array() += kSoftness / count;
      const Eigen::ArrayXd factor = 1 + (moments.transpose() * normal.llt().solve(missing)).array();
      power.col(c).array() *= factor.max(kLeastFactor).min(kMostFactor);
    }
}

}  // namespace lightwell
