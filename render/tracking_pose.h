// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "render/scene.h"

namespace lightwell::render {

// Where a tracked camera stands on its stage and how it looks. Stage: right-handed, +Z up; at zero angles the camera
// looks along +Y with +X at its right. Turned first by pan about Z, then by tilt about the turned X, then by roll about
// the turned Y, each by the right-hand rule: to the left, upward, clockwise as seen from behind.
struct TrackedCamera {
  Vec3d position_m = Vec3d::Zero();
  Eigen::Matrix3d stage_from_camera = Eigen::Matrix3d::Identity();
  std::optional<double> focal_length_mm;
  std::optional<double> sensor_height_mm;
};

Eigen::Matrix3d rotation_from_pan_tilt_roll(double pan_deg, double tilt_deg, double roll_deg);

// Stages and scenes reach this far. Farther is a fault of the stream.
inline constexpr double kFarthestTracked_m = 1e6;

// The scene's camera at the tracked place: stage (x, y, z) is world (x, z, −y). The field of view is 2 atan(h / 2f)
// where focal length f and sensor height h are known, else the camera's own.
SceneCamera tracked_camera(const TrackedCamera& tracked, const SceneCamera& camera);

}  // namespace lightwell::render
