// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lighting/polar_map.h"

namespace lightwell {

inline constexpr int kGroundPoints = 256;

// Horizontal irradiance of every ground point, lux, RGB.
using GroundIrradiance = Eigen::Array<double, kGroundPoints, 3>;

// The ground under the probe: 16 × 16 points in the plane y = 0, spacing 6/16, centred, and a unit sphere that rests on
// its origin and hides a part of the light, as in lighting/evaluation/evaluate.h. Here the shadow has a soft edge: what
// is seen of a light rises from none to all over 8° around the sphere's outline, as of a lamp that wide, so that the
// irradiance has a derivative by the light's direction everywhere.
// The probe blurs light so much that more than about six lights fit it alike; a shadow's edge tells them apart.
class ShadowGround {
 public:
  ShadowGround();

  // Exact over the map's bins, each a light in its centre; what is not finite and positive counts as 0.
  [[nodiscard]] GroundIrradiance irradiance(const PolarMap& map) const;
  // What a light of unit illuminance gives, [256]; 0 from below the horizon.
  void light_column(const Vec3d& direction, double* values) const noexcept;
  void slope_columns(const Vec3d& direction, const Vec3d& t, const Vec3d& u, double* along_t,
                     double* along_u) const noexcept;
  // What unit radiance from everywhere gives.
  void ambient_column(double* values) const noexcept;

 private:
  struct Point {
    Vec3d to_centre;  // unit, toward the sphere's centre
    double cosine;    // of the angle between that and the sphere's outline
    double sine;
    double distance;  // of the centre
  };
  std::vector<Point> points_;
};

}  // namespace lightwell
