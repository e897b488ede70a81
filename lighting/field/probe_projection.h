// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <variant>

#include "lighting/lens.h"
#include "lighting/vector.h"

namespace lightwell {

// What a place in a probe's picture saw: radiance that arrives at the origin from the direction.
struct ProbeRay {
  Vec3d direction;               // world, unit, toward the light
  Vec3d origin = Vec3d::Zero();  // metres from the probe's position
};

// Pictures of latitude and longitude (lighting/direction.h), of one point; what lies farther from +Y than theta_max_rad
// they do not show.
struct LatLongProbe {
  double theta_max_rad = kPi;
};

// A mirror ball whose picture is the circle that touches the image's sides, seen by a camera that looks along −Z with its
// right side toward +X: the middle of the picture shows what is at +Z, the rim what is behind the ball. The probe's
// position is the ball's centre; a ray's origin is where it met the ball, for a ball has no single viewpoint.
struct MirrorBallProbe {
  double radius_m = 0;  // 0: so small that all rays meet in its centre
  std::optional<double>
      camera_distance_m;  // from the ball's centre, above the radius; none: so far that its rays are parallel
  double blind_cone_rad =
      2.1 * kPi / 180;  // half angle about −Z, where the rim shows nothing: 4.2° across in Löw et al. 2009
};

// Half angle of what the ball hides: the blind cone, or what stands behind the ball as its camera sees it.
double blind_cone_rad(const MirrorBallProbe& ball);

// A fisheye camera at the probe's position, its lens as calibrated (lighting/lens.h), its zenith at +Y.
struct FisheyeProbe {
  Lens lens;
};

using ProbeProjection = std::variant<LatLongProbe, MirrorBallProbe, FisheyeProbe>;

// The ray of a place in an image of width × height pixels: x from 0 to width, y from 0 at the top to height, pixel centres
// at +½. None where the picture shows nothing.
std::optional<ProbeRay> ray_of(const ProbeProjection& projection, int width, int height, double x, double y);

}  // namespace lightwell
