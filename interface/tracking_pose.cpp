// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/tracking_pose.h"

#include <Eigen/Geometry>
#include <cmath>

namespace lightwell {
namespace {

Eigen::Matrix3d world_from_stage() {
  Eigen::Matrix3d m;
  m << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  return m;
}

}  // namespace

Eigen::Matrix3d rotation_from_pan_tilt_roll(double pan_deg, double tilt_deg, double roll_deg) {
  const auto turn = [](double deg, const Vec3d& axis) {
    return Eigen::AngleAxisd(std::remainder(deg, 360.0) * kPi / 180, axis);
  };
  return (turn(pan_deg, Vec3d::UnitZ()) * turn(tilt_deg, Vec3d::UnitX()) * turn(roll_deg, Vec3d::UnitY()))
      .toRotationMatrix();
}

PanTiltRoll pan_tilt_roll_from(const Eigen::Matrix3d& r) {
  const auto degrees = [](double rad) { return rad * 180 / kPi; };
  const double level = std::hypot(r(2, 0), r(2, 2));  // cosine of the tilt
  const double tilt_deg = degrees(std::atan2(r(2, 1), level));
  if (level < 1e-9) return {degrees(std::atan2(r(1, 0), r(0, 0))), tilt_deg, 0};
  return {degrees(std::atan2(-r(0, 1), r(1, 1))), tilt_deg, degrees(std::atan2(-r(2, 0), r(2, 2)))};
}

ProbePose pose_from_tracked(const TrackedCamera& tracked) {
  const Eigen::Matrix3d axes = world_from_stage();
  return {axes * tracked.position_m,
          Eigen::Quaterniond(axes * tracked.stage_from_camera * axes.transpose()).normalized()};
}

TrackedCamera tracked_from_pose(const ProbePose& pose) {
  const Eigen::Matrix3d axes = world_from_stage();
  TrackedCamera tracked;
  tracked.position_m = axes.transpose() * pose.position_m;
  tracked.stage_from_camera = axes.transpose() * pose.world_from_probe.toRotationMatrix() * axes;
  return tracked;
}

}  // namespace lightwell
