// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "calibration/lens/correspondences.h"
#include "calibration/lens/lens_calibration.h"

namespace lightwell::calibration {

// Points that count, by angle off axis and azimuth: [ring][sector]. The last ring ends with the field: half a ring
// or less beyond a whole one belongs to it.
struct FieldCoverage {
  double ring_deg = 10;
  std::vector<std::vector<std::size_t>> points;

  static constexpr std::size_t kSectors = 12;
};
FieldCoverage field_coverage(const LensCalibration& calibration, const TargetViews& target_views);

// Azimuth of a direction in the camera's frame, in [0, 2π): 0 at the top of the image, growing to its right.
double azimuth_rad(const Vec3d& camera_direction);

}  // namespace lightwell::calibration
