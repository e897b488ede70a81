// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lighting/light_set.h"
#include "lighting/polar_map.h"

namespace lightwell {

// Lloyd's relaxation on the map itself: from one light on, a light is added in the cell of most power, and
// every light moves to the luminance-weighted mean of its Voronoi cell until none moves; each has the power of
// its cell. Cells of one bin are not divided; where fewer lit bins than lights exist, the rest have no power.
// Order: of adding.    count: 1 to 100,000    source: Kollig and Keller 2003, "Efficient Illumination by High
// Dynamic Range Images"
std::vector<DirectionalLight> kollig_keller(const PolarMap& map, int count);

}  // namespace lightwell
