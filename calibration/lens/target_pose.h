// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "calibration/lens/correspondences.h"
#include "lighting/lens.h"

namespace lightwell::calibration {

// Where the target stands in front of the camera: p_camera = rotation · p_target + translation.
struct TargetPose {
  Vec3d rotation = Vec3d::Zero();  // angle-axis, radians
  Vec3d translation_mm = Vec3d::Zero();

  [[nodiscard]] Eigen::Matrix3d camera_from_target() const;
};
TargetPose target_pose(const Eigen::Matrix3d& camera_from_target, const Vec3d& translation_mm);

// [v]×: cross_matrix(v) · p = v × p
Eigen::Matrix3d cross_matrix(const Vec3d& v);

// Pixel error of every point: |projection − pixel|.
std::vector<double> errors_px(const Lens& lens, const TargetPose& pose,
                              std::span<const Correspondence> points);

// The target's pose by direct linear transformation on rays instead of image points, so that points behind the
// image plane count like any other. Flat and solid targets; points: at least 4 of a flat one, no three on a
// line, 6 of a solid one. Nothing where they do not determine a pose.
std::optional<TargetPose> pose_from_rays(const Lens& lens, std::span<const Correspondence> points);

// The same where some points are wrong: the pose that fits the middle of the points best, over samples of
// them (least median of squares, Rousseeuw 1984), then refined. Deterministic.
std::optional<TargetPose> robust_pose(const Lens& lens, std::span<const Correspondence> points);

// Least squares in the image from a start, Huber's weights beyond `huber_px` (infinity: all alike).
TargetPose refined_pose(const Lens& lens, TargetPose pose, std::span<const Correspondence> points,
                        double huber_px);

}  // namespace lightwell::calibration
