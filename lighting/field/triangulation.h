// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "lighting/vector.h"

namespace lightwell {

// Toward a lamp, from where it was seen.
struct SightRay {
  Vec3d origin;     // metres
  Vec3d direction;  // unit
};

struct LampPlace {
  Vec3d position = Vec3d::Zero();
  double sigma_m = 0;       // standard deviation along the least certain axis, from the rays' own scatter
  double residual_rad = 0;  // RMS angle between the rays and the place
};

// Where two rays pass each other closest, in the middle between them; none where that is behind an origin or nearer to it
// than least_m, or where they are within 3° of parallel.
std::optional<Vec3d> meeting_point(const SightRay& a, const SightRay& b, double least_m);

// The place that rays see under the least square angle, from a first guess, by Gauss–Newton. Rays are taken to err by .4°
// or as much as they scatter. None for fewer than two rays, rays from one place or parallel ones, and places behind an
// origin.
std::optional<LampPlace> triangulate(std::span<const SightRay> rays, const Vec3d& guess);

}  // namespace lightwell
