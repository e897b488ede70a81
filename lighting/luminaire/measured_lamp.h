// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "lighting/luminaire/bell_basis.h"
#include "lighting/luminaire/lamp_planes.h"

namespace lightwell {

// A lamp as its rig measures it: E_mn, the irradiance of the measurement plane through a filter Φ'_mn on the sampling
// plane, per unit of the filter's integral: what evenly bright glass of one spacing squared would give is spacing² times
// this. May be negative where the filter is.
// source: Granier et al. 2003, equation 2
struct MeasuredLamp {
  LampImages irradiance;  // [lux / m²]
  BellDual filter = BellDual::finite;
};

// The papers' two ways back to radiance, cd/m², along the ray from (u, v) on the sampling plane to (s, t).
enum class LampForm {
  exact,            // R² / cos² of the ray itself (equation 5)
  shift_invariant,  // R² / cos² from each position (equations 8 to 11): its images are spots
};
Rgbd radiance(const MeasuredLamp& lamp, LampForm form, const Vec2d& sampling, const Vec2d& measurement);

// Of a surface at a point below the sampling plane (else 0); normal: unit. Lux. The integral of equation 12 over the
// sampling plane, two Gauss–Legendre points a piece of the bells each way: as exact as the form.
Rgbd illuminance(const MeasuredLamp& lamp, LampForm form, const Vec3d& point, const Vec3d& normal);

// A lamp that is known everywhere: radiance along rays.
using LampRadiance = std::function<Rgbd(const Vec2d& sampling, const Vec2d& measurement)>;
// What a rig would measure of it: the filter's integral at each pixel's centre. `steps` Gauss–Legendre panels of three
// points between the filter's knots.
MeasuredLamp measure(const LampRadiance& lamp, const LampPlanes& planes, BellDual filter, int steps = 1);

}  // namespace lightwell
