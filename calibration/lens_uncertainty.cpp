// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/lens_uncertainty.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace lightwell {
namespace {

Eigen::Matrix<double, 2, 3> by_turn(const LensJacobian& j, const Vec3d& d) {
  Eigen::Matrix3d cross;
  cross << 0, -d.z(), d.y(), d.z(), 0, -d.x(), -d.y(), d.x(), 0;
  return -j.dpixel_ddirection * cross;
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

double azimuth_rad(const Vec3d& camera_direction) {
  const double angle = std::atan2(camera_direction.x(), -camera_direction.y());
  return angle < 0 ? angle + 2 * kPi : angle;
}

Coverage coverage_of(const LensCalibration& calibration, const TargetViews& target_views) {
  Coverage out;
  const double field_deg = calibration.lens.max_theta_rad * 180 / kPi;
  const auto rings = static_cast<std::size_t>(std::ceil(field_deg / out.ring_deg));
  out.points.assign(std::max<std::size_t>(1, rings), std::vector<std::size_t>(Coverage::kSectors, 0));
  for (std::size_t v = 0; v < calibration.views.size(); ++v) {
    const ViewResult& view = calibration.views[v];
    if (!view.used) continue;
    const auto& points = target_views.views[v].points;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (std::binary_search(view.rejected.begin(), view.rejected.end(), i)) continue;
      const Vec3d d = calibration.lens.unproject(points[i].pixel);
      const double theta_deg = std::atan2(d.head<2>().norm(), d.z()) * 180 / kPi;
      const auto ring = std::min(out.points.size() - 1, static_cast<std::size_t>(theta_deg / out.ring_deg));
      const auto sector = static_cast<std::size_t>(azimuth_rad(d) / (2 * kPi) * Coverage::kSectors);
      ++out.points[ring][std::min(sector, Coverage::kSectors - 1)];
    }
  }
  return out;
}

}  // namespace lightwell
