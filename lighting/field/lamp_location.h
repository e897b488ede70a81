// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <span>

#include "lighting/field/triangulation.h"

namespace lightwell {

// Where a lamp stands that several probes see, be it near or too far to tell.
struct LampLocation {
  Vec3d direction = Vec3d::UnitY();  // from the first ray's origin, unit
  double inverse_distance = 0;       // 1/m, from there; 0 or less: as if infinitely far
  double inverse_sigma = 0;  // its standard deviation; infinite where nothing is known of the distance
  double chi_square = 0;     // of the rays about it, in squares of their stated errors
  int degrees_of_freedom = 0;
  // Where is_near():
  Vec3d position = Vec3d::Zero();                        // metres
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of position, m²

  static constexpr double kNear =
      0.15;  // of the distance: its standard deviation, up to which a lamp has a place

  [[nodiscard]] bool is_near() const {
    return inverse_distance > 0 && inverse_sigma <= kNear * inverse_distance;
  }
  // 95 of 100 distances lie between; the far one may be infinite, the near one 0.
  struct Range {
    double near_m = 0, far_m = std::numeric_limits<double>::infinity();
  };
  [[nodiscard]] Range distance() const;
};

// The direction and inverse distance from the first ray's origin under which rays err least, by Gauss–Newton; errors of
// rays are normal, sigma_rad each way. Inverse distance is as good a number for the sun as for a lamp at arm's length, its error is
// nearly normal, and rays that diverge a little are no special case. Where rays scatter more than they claim, so does
// the result. None for no ray, or where the rays contradict each other by more than a right angle.
// source: Civera, Davison and Montiel 2008, "Inverse depth parametrization for monocular SLAM", section III
std::optional<LampLocation> locate_lamp(std::span<const SightRay> rays, double sigma_rad);

}  // namespace lightwell
