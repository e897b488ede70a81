// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/lens/target_pose.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "lighting/median.h"

namespace lightwell::calibration {
namespace {

// The target's own axes: points = centre + scale · axes · (a, b, c), c = 0 on a flat target.
struct TargetAxes {
  Vec3d centre;
  Eigen::Matrix3d axes;  // right-handed
  double scale = 1;
  bool flat = true;
};

std::optional<TargetAxes> axes_of(std::span<const Correspondence> points) {
  TargetAxes out;
  out.centre.setZero();
  for (const auto& p : points) out.centre += p.target_mm;
  out.centre /= static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const auto& p : points) spread += (p.target_mm - out.centre) * (p.target_mm - out.centre).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(spread);
  const Vec3d value = eigen.eigenvalues();                       // ascending
  if (!(value[2] > 0) || value[1] < 1e-8 * value[2]) return {};  // one place, or a line
  out.axes.col(0) = eigen.eigenvectors().col(2);
  out.axes.col(1) = eigen.eigenvectors().col(1);
  out.axes.col(2) = out.axes.col(0).cross(out.axes.col(1));
  out.scale = std::sqrt(value[2] / static_cast<double>(points.size()));
  out.flat = value[0] < 1e-4 * value[2];  // a board bends by less than a hundredth of its width
  return out;
}

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& m) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vec3d sign(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
  return svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
}

// d × (P x) = 0 for every ray d and point x in homogeneous coordinates; the solution is the normal matrix's
// eigenvector of the smallest eigenvalue. Columns: x's, 3 (flat) or 4.
template <int Columns>
std::optional<Eigen::Matrix<double, 3, Columns>> linear_projection(
    const std::vector<Vec3d>& rays, const std::vector<Eigen::Matrix<double, Columns, 1>>& x) {
  constexpr int kUnknowns = 3 * Columns;
  Eigen::Matrix<double, kUnknowns, kUnknowns> normal = Eigen::Matrix<double, kUnknowns, kUnknowns>::Zero();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    // Σ (I − d dᵀ) ⊗ (x xᵀ): the squared part of P x across the ray.
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - rays[i] * rays[i].transpose();
    const Eigen::Matrix<double, Columns, Columns> square = x[i] * x[i].transpose();
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c)
        normal.template block<Columns, Columns>(r * Columns, c * Columns) += across(r, c) * square;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, kUnknowns, kUnknowns>> eigen(normal);
  if (eigen.info() != Eigen::Success) return {};
  // Two solutions alike: the points do not determine one.
  if (eigen.eigenvalues()[1] < 1e-12 * eigen.eigenvalues()[kUnknowns - 1]) return {};
  Eigen::Matrix<double, 3, Columns> p;
  for (int r = 0; r < 3; ++r)
    p.row(r) = eigen.eigenvectors().col(0).template segment<Columns>(r * Columns).transpose();
  // The points lie on the rays, not on their backs.
  int forward = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) forward += rays[i].dot(p * x[i]) > 0 ? 1 : -1;
  return forward >= 0 ? p : Eigen::Matrix<double, 3, Columns>(-p);
}

std::optional<TargetPose> pose_in_axes(const TargetAxes& axes, const Eigen::Matrix3d& camera_from_axes,
                                       const Vec3d& translation) {
  const Eigen::Matrix3d rotation = camera_from_axes * axes.axes.transpose();
  const Vec3d t = axes.scale * translation - rotation * axes.centre;
  if (!rotation.allFinite() || !t.allFinite()) return {};
  return target_pose(rotation, t);
}

std::optional<TargetPose> flat_pose(const TargetAxes& axes, const std::vector<Vec3d>& rays,
                                    std::span<const Correspondence> points) {
  std::vector<Vec3d> x;
  for (const auto& p : points) {
    const Vec3d local = axes.axes.transpose() * (p.target_mm - axes.centre) / axes.scale;
    x.emplace_back(local.x(), local.y(), 1);
  }
  const auto h = linear_projection<3>(rays, x);
  if (!h) return {};
  const double scale = (h->col(0).norm() + h->col(1).norm()) / 2;
  Eigen::Matrix3d r;
  r << h->col(0) / scale, h->col(1) / scale, h->col(0).cross(h->col(1)) / (scale * scale);
  return pose_in_axes(axes, nearest_rotation(r), h->col(2) / scale);
}

std::optional<TargetPose> solid_pose(const TargetAxes& axes, const std::vector<Vec3d>& rays,
                                     std::span<const Correspondence> points) {
  std::vector<Eigen::Vector4d> x;
  for (const auto& p : points) {
    const Vec3d local = axes.axes.transpose() * (p.target_mm - axes.centre) / axes.scale;
    x.emplace_back(local.x(), local.y(), local.z(), 1);
  }
  const auto p = linear_projection<4>(rays, x);
  if (!p) return {};
  const Eigen::Matrix3d m = p->leftCols<3>();
  const double scale = std::cbrt(m.determinant());
  if (!(scale > 0)) return {};  // a mirror image is no pose
  return pose_in_axes(axes, nearest_rotation(m / scale), p->col(3) / scale);
}

}  // namespace

Eigen::Matrix3d cross_matrix(const Vec3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Matrix3d TargetPose::camera_from_target() const {
  const double angle = rotation.norm();
  if (angle == 0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
}

TargetPose target_pose(const Eigen::Matrix3d& camera_from_target, const Vec3d& translation_mm) {
  const Eigen::AngleAxisd turn(camera_from_target);
  return {turn.angle() * turn.axis(), translation_mm};
}

std::vector<double> errors_px(const Lens& lens, const TargetPose& pose,
                              std::span<const Correspondence> points) {
  const Eigen::Matrix3d rotation = pose.camera_from_target();
  std::vector<double> errors;
  errors.reserve(points.size());
  for (const auto& p : points)
    errors.push_back((lens.project(rotation * p.target_mm + pose.translation_mm) - p.pixel).norm());
  return errors;
}

std::optional<TargetPose> pose_from_rays(const Lens& lens, std::span<const Correspondence> points) {
  if (points.size() < 4) return {};
  const auto axes = axes_of(points);
  if (!axes || (!axes->flat && points.size() < 6)) return {};
  std::vector<Vec3d> rays;
  rays.reserve(points.size());
  for (const auto& p : points) rays.push_back(lens.unproject(p.pixel));
  if (!axes->flat)
    if (const auto pose = solid_pose(*axes, rays, points)) return pose;
  return flat_pose(*axes, rays, points);
}

TargetPose refined_pose(const Lens& lens, TargetPose pose, std::span<const Correspondence> points,
                        double huber_px) {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  const auto cost_of = [&](const TargetPose& at) {
    double sum = 0;
    for (const double e : errors_px(lens, at, points))
      sum += e <= huber_px ? e * e : huber_px * (2 * e - huber_px);
    return sum;
  };
  double cost = cost_of(pose);
  double damping = 1e-4;
  for (int i = 0; i < 30; ++i) {
    const Eigen::Matrix3d rotation = pose.camera_from_target();
    Matrix6 normal = Matrix6::Zero();
    Vector6 slope = Vector6::Zero();
    for (const auto& p : points) {
      const Vec3d turned = rotation * p.target_mm;
      const LensJacobian j = project_with_jacobian(lens, turned + pose.translation_mm);
      const Vec2d error = j.pixel - p.pixel;
      const double weight = error.norm() <= huber_px ? 1 : huber_px / error.norm();
      Eigen::Matrix<double, 2, 6> by_pose;
      by_pose << -j.dpixel_ddirection * cross_matrix(turned), j.dpixel_ddirection;
      normal += weight * by_pose.transpose() * by_pose;
      slope += weight * by_pose.transpose() * error;
    }
    if (!normal.allFinite()) return pose;
    Matrix6 damped = normal;
    damped.diagonal() *= 1 + damping;
    const Vector6 step = damped.ldlt().solve(-slope);
    const Vec3d turn = step.head<3>();
    const TargetPose next = target_pose(TargetPose{turn, Vec3d::Zero()}.camera_from_target() * rotation,
                                        pose.translation_mm + step.tail<3>());
    const double next_cost = step.allFinite() ? cost_of(next) : std::numeric_limits<double>::infinity();
    if (!(next_cost < cost)) {
      if (damping > 1e8) break;
      damping *= 10;
      continue;
    }
    const bool settled = next_cost > cost * (1 - 1e-10);
    pose = next;
    cost = next_cost;
    damping = std::max(1e-12, damping / 10);
    if (settled) break;
  }
  return pose;
}

std::optional<TargetPose> robust_pose(const Lens& lens, std::span<const Correspondence> points) {
  std::optional<TargetPose> best = pose_from_rays(lens, points);
  double best_median =
      best ? median(errors_px(lens, *best, points)) : std::numeric_limits<double>::infinity();
  // 60 samples of 6: one is free of wrong points in 99.6 % of the cases with every third point wrong, 1 − (1 − (2/3)⁶)⁶⁰.
  constexpr int kSamples = 60;
  constexpr std::size_t kSize = 6;
  if (points.size() > kSize) {
    std::mt19937 random(1);
    std::vector<Correspondence> sample(points.begin(), points.end());
    for (int s = 0; s < kSamples; ++s) {
      for (std::size_t i = 0; i < kSize; ++i)
        std::swap(sample[i], sample[i + random() % (sample.size() - i)]);
      const auto pose = pose_from_rays(lens, std::span(sample).first(kSize));
      if (!pose) continue;
      const double middle = median(errors_px(lens, *pose, points));
      if (middle < best_median) {
        best_median = middle;
        best = pose;
      }
    }
  }
  if (!best) return {};
  return refined_pose(lens, *best, points, std::max(1e-3, 2 * best_median));
}

}  // namespace lightwell::calibration
