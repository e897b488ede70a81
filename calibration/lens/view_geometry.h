// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibration/lens/correspondences.h"
#include "lighting/lens.h"

namespace lightwell::calibration {

// Largest angle between the normals of flat targets, degrees, seen from the camera. Nothing where a target is solid:
// its depth alone separates focal length and distance.
// turns: camera_from_target of each view; points: of each view
std::optional<double> spread_of_normals_deg(const std::vector<Eigen::Matrix3d>& turns,
                                            const std::vector<std::vector<Correspondence>>& points);

// How far from the lens's centre the points reach, in units of the way from the image's middle to its nearest edge.
double reach_of_points(const Lens& lens, const std::vector<std::vector<Correspondence>>& points);

}  // namespace lightwell::calibration
