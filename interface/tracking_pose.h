// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "lighting/field/pose_track.h"

namespace lightwell {

// Where a tracked camera stands on its stage and how it looks. Stage: right-handed, +Z up; at zero angles the camera
// looks along +Y with +X at its right. Turned first by pan about Z, then by tilt about the turned X, then by roll about
// the turned Y, each by the right-hand rule: to the left, upward, clockwise as seen from behind.
struct TrackedCamera {
  Vec3d position_m = Vec3d::Zero();
  Eigen::Matrix3d stage_from_camera = Eigen::Matrix3d::Identity();
  std::optional<double> focal_length_mm;
  std::optional<double> sensor_height_mm;
  std::optional<std::int64_t> sampled_ns;  // by the tracker's own clock, of any epoch
  std::optional<int> number;               // of the camera: FreeD's id, OpenTrackIO's sourceNumber
};

struct PanTiltRoll {
  double pan_deg = 0, tilt_deg = 0, roll_deg = 0;
};
Eigen::Matrix3d rotation_from_pan_tilt_roll(double pan_deg, double tilt_deg, double roll_deg);
// The other way: pan and roll in ±180°, tilt in ±90°. Straight up or down, where only their sum is told, roll is 0.
PanTiltRoll pan_tilt_roll_from(const Eigen::Matrix3d& stage_from_camera);

// Stages and scenes reach this far. Farther is a fault of the stream.
inline constexpr double kFarthestTracked_m = 1e6;

// In the world: stage (x, y, z) is world (x, z, −y). The body's own frame is the world's at zero angles.
ProbePose pose_from_tracked(const TrackedCamera& tracked);
// The other way, without a lens.
TrackedCamera tracked_from_pose(const ProbePose& pose);

}  // namespace lightwell
