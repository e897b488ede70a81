// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "lighting/vector.h"

namespace lightwell {

// What stands between the light and the ground plane y = 0. Each is convex or flat and symmetric about +Y.
enum class Occluder {
  sphere,  // radius 1, resting on the origin
  box,     // 1.4 × 1.4 wide, 2 high, standing on the origin, sides along x and z
  pole,    // cylinder of radius 0.15, 3 high, standing on the origin: a thin shadow with sharp edges
  canopy,  // horizontal disc of radius 1.5, 2 above the origin: light comes in from below its edge
};
inline constexpr std::array kOccluders = {Occluder::sphere, Occluder::box, Occluder::pole, Occluder::canopy};

std::string_view name(Occluder occluder);
std::optional<Occluder> occluder_from_name(std::string_view name);
std::string occluder_names();  // "sphere, box, …", for help and errors

// A stretch of azimuth: middle ± half, radians. half ≤ 0: nothing, half ≥ π: all of it.
struct AzimuthArc {
  double middle_rad = 0;
  double half_rad = 0;
};

// The azimuths at which the occluder hides the directions of one zenith angle (below π/2) from a ground point.
// Always one arc: a ray of that slope meets the occluder where its ground track, a disc's radius long, meets a
// convex footprint, and two convex shapes intersect in one.
// point: y = 0
AzimuthArc hidden_arc(Occluder occluder, const Vec3d& point, double sin_theta, double cos_theta);

// Whether the occluder hides a direction (any length above 0, y > 0) from a ground point. Computed on its own,
// as a ray against the body.
bool hides(Occluder occluder, const Vec3d& point, const Vec3d& direction);

// Horizontal irradiance that the occluder takes away at a ground point under radiance 1 from everywhere: closed
// forms, the pole's by a quadrature good to 1e-6.
double hidden_of_uniform_sky(Occluder occluder, const Vec3d& point);

}  // namespace lightwell
