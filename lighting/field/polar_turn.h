// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lighting/polar_map.h"

namespace lightwell {

// The map of a probe that was set up turned about +Y: what it shows at azimuth λ comes to stand at λ + heading_rad. Between
// sectors light is shared linearly, so that each ring keeps its sum. Radiance and grid alone are set in `turned`, whose
// memory is reused; map and turned are two.
void turn_about_zenith(const PolarMap& map, double heading_rad, PolarMap& turned);

}  // namespace lightwell
