// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/lens/lens_uncertainty.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace lightwell::calibration {
namespace {

Eigen::Matrix<double, 2, 3> by_turn(const LensJacobian& j, const Vec3d& d) {
  return -j.dpixel_ddirection * cross_matrix(d);
}

}  // namespace

ProjectionUncertainty::ProjectionUncertainty(const Lens& lens, const Eigen::Matrix<double, 8, 8>& covariance)
    : lens_(lens), covariance_(covariance) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 8> mixed = Eigen::Matrix<double, 3, 8>::Zero();
  constexpr int kRings = 24, kSectors = 24;
  for (int ring = 0; ring < kRings; ++ring) {
    const double z = 1 + (std::cos(lens.max_theta_rad) - 1) * (ring + 0.5) / kRings;  // equal areas
    const double h = std::sqrt(std::max(0.0, 1 - z * z));
    for (int sector = 0; sector < kSectors; ++sector) {
      const double phi = 2 * kPi * sector / kSectors;
      const Vec3d d(h * std::cos(phi), h * std::sin(phi), z);
      const LensJacobian j = project_with_jacobian(lens, d);
      const Eigen::Matrix<double, 2, 3> turn = by_turn(j, d);
      normal += turn.transpose() * turn;
      mixed += turn.transpose() * j.dpixel_dlens;
    }
  }
  turn_dlens_ = -normal.ldlt().solve(mixed);
}

Eigen::Matrix2d ProjectionUncertainty::covariance_px2(const Vec3d& direction) const {
  const LensJacobian j = project_with_jacobian(lens_, direction);
  const Eigen::Matrix<double, 2, 8> total = j.dpixel_dlens + by_turn(j, direction) * turn_dlens_;
  return total * covariance_ * total.transpose();
}

double ProjectionUncertainty::worst_px(const Vec3d& direction) const {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(covariance_px2(direction));
  return std::sqrt(std::max(0.0, eigen.eigenvalues()[1]));
}

}  // namespace lightwell::calibration
