// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lighting/polar_map.h"

namespace lightwell {

// Lux on a small white plane that faces `normal` (unit, world): Σ radiance × solid angle × max(0, normal · direction), a
// bin's light from its centre. What a luxmeter held there reads, of the part of the sphere that was measured.
Rgbd plane_illuminance(const PolarMap& map, const Vec3d& normal);

}  // namespace lightwell
