// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "lighting/vector.h"

// Directions and the two parametrisations of the sphere (docs/conventions.md). World frame: right-handed, +Y up.
namespace lightwell {

// zenith angle theta from +Y, azimuth lambda from +Z toward +X, radians
struct Spherical {
  double theta_rad = 0;
  double lambda_rad = 0;
};

inline Vec3d direction_from_spherical(const Spherical& s) {
  const double st = std::sin(s.theta_rad);
  return {st * std::sin(s.lambda_rad), std::cos(s.theta_rad), st * std::cos(s.lambda_rad)};
}

// direction: any non-zero length; lambda in [0, 2π), 0 at the poles
inline Spherical spherical_from_direction(const Vec3d& d) {
  const double horizontal = std::hypot(d.x(), d.z());
  double lambda = horizontal > 0 ? std::atan2(d.x(), d.z()) : 0;
  if (lambda < 0) lambda += 2 * kPi;
  if (lambda >= 2 * kPi) lambda = 0;
  return {std::atan2(horizontal, d.y()), lambda};
}

// Latitude–longitude image (OpenEXR envmap): u right, v down, both in [0,1]; theta = πv, lambda = π(1 − 2u).
inline Vec3d direction_from_lat_long(double u, double v) {
  return direction_from_spherical({kPi * v, kPi * (1 - 2 * u)});
}

// u in [0,1), v in [0,1]
inline Vec2d lat_long_from_direction(const Vec3d& d) {
  const Spherical s = spherical_from_direction(d);
  double u = (1 - s.lambda_rad / kPi) / 2;
  u -= std::floor(u);
  return {u, std::clamp(s.theta_rad / kPi, 0.0, 1.0)};
}

}  // namespace lightwell
