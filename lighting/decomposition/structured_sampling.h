// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lighting/light_set.h"
#include "lighting/polar_map.h"

namespace lightwell {

// Structured importance sampling. The map is cut into layers at whole multiples of its luminance's standard
// deviation; each connected region of a layer gets lights in proportion to (its power) · (its solid
// angle)^¼, between importance by light and by area (section 3); brightest layer first, they are spread over
// the region by taking, again and again, the place farthest from all lights so far (Hochbaum and Shmoys
// 1985). The bins nearest to a place are its stratum; a light has all of its stratum's power and stands at
// its luminance-weighted mean.
//
// Counts are rounded by the largest remainder, so exactly `count` lights come out; a region holds no more
// lights than bins, and where fewer lit bins than lights exist, the rest have no power. Order: of
// placing.    count: 1 to 100,000    source: Agarwal, Ramamoorthi, Belongie and Jensen 2003
std::vector<DirectionalLight> structured_sampling(const PolarMap& map, int count);

}  // namespace lightwell
