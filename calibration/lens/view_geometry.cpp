// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/lens/view_geometry.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace lightwell::calibration {
namespace {

// Unit normal of a flat target in its own frame.
std::optional<Vec3d> normal_of(const std::vector<Correspondence>& points) {
  Vec3d centre = Vec3d::Zero();
  for (const auto& p : points) centre += p.target_mm / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const auto& p : points) spread += (p.target_mm - centre) * (p.target_mm - centre).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(spread);
  if (eigen.eigenvalues()[0] > 1e-4 * eigen.eigenvalues()[2]) return {};
  return eigen.eigenvectors().col(0);
}

}  // namespace

std::optional<double> spread_of_normals_deg(const std::vector<Eigen::Matrix3d>& turns,
                                            const std::vector<std::vector<Correspondence>>& points) {
  std::vector<Vec3d> normals;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const auto normal = normal_of(points[i]);
    if (!normal) return {};
    normals.push_back(turns[i] * *normal);
  }
  double largest = 0;
  for (const Vec3d& a : normals)
    for (const Vec3d& b : normals)
      largest = std::max(largest, std::atan2(a.cross(b).norm(), std::abs(a.dot(b))));
  return largest * 180 / kPi;
}

double reach_of_points(const Lens& lens, const std::vector<std::vector<Correspondence>>& points) {
  const double edge = std::min(lens.image_size[0], lens.image_size[1]) / 2.0;
  double reach = 0;
  for (const auto& view : points)
    for (const auto& p : view) reach = std::max(reach, (p.pixel - lens.center).norm() / edge);
  return reach;
}

}  // namespace lightwell::calibration
