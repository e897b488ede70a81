// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/tracking_pose.h"

#include <Eigen/Geometry>
#include <cmath>

namespace lightwell::render {
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

SceneCamera tracked_camera(const TrackedCamera& tracked, const SceneCamera& camera) {
  SceneCamera result = camera;
  const Eigen::Matrix3d axes = world_from_stage();
  result.world_from_camera = Mat4f::Identity();
  result.world_from_camera.topLeftCorner<3, 3>() =
      (axes * tracked.stage_from_camera * axes.transpose()).cast<float>();
  result.world_from_camera.topRightCorner<3, 1>() = (axes * tracked.position_m).cast<float>();
  if (tracked.focal_length_mm && tracked.sensor_height_mm)
    result.yfov_rad =
        static_cast<float>(2 * std::atan(*tracked.sensor_height_mm / (2 * *tracked.focal_length_mm)));
  return result;
}

}  // namespace lightwell::render
