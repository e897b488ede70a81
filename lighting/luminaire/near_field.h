// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lighting/luminaire/measured_lamp.h"

namespace lightwell {

// A lamp as point sources on a grid: each sends the luminous intensity of its image, cd, toward (s, t), the light of one
// square of the grid. Their sum is the trapezoidal rule over the sampling plane, which for smooth lamps converges faster
// than any power of the spacing, while the bells of the paper do not even reproduce a straight line.
struct NearField {
  LampImages intensity;
};

// What the rig's filter has blurred across positions is undone to fourth order (by its second and fourth moment).
NearField point_sources(const MeasuredLamp& lamp);

// Sources a spacing each way that a place this far from the sampling plane asks for: they stand no farther apart than a
// third of its distance, up to 16.
int subdivision_at(const NearField& lamp, double distance_m);

// Of a surface at a point below the sampling plane (else 0); normal: unit. Lux, 0 or more. Where sources are
// subdivided, the light toward a fixed point of the measurement plane is interpolated between positions (cubic
// convolution): neighbours see that point alike. The flux is the same at every subdivision.
Rgbd illuminance(const NearField& lamp, const Vec3d& point, const Vec3d& normal, int subdivision);
inline Rgbd illuminance(const NearField& lamp, const Vec3d& point, const Vec3d& normal) {
  const double below = lamp.intensity.planes.z_m - point.z();
  return below > 0 ? illuminance(lamp, point, normal, subdivision_at(lamp, below)) : Rgbd(Rgbd::Zero());
}

// Through the images, lm.
Rgbd luminous_flux(const NearField& lamp);

}  // namespace lightwell
