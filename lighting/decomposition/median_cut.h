// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lighting/light_set.h"
#include "lighting/polar_map.h"

namespace lightwell {

// Every region is divided into two of equal luminance along its longer side, round after round; a light
// stands at the luminance-weighted mean direction of each region with all the region's power. For a count
// that is no power of two the last round divides the brightest regions only. Lights carry parents: the first
// n are the cut's own n regions. A region of one bin or without light is not divided; where fewer regions
// than lights exist, the rest have no power.
//
// The map is opened opposite its light's mean azimuth: opened at a fixed one, a sun there is cut in two from the
// start (a tenth more error over real maps), and turning the map changes the lights.
//
// count: 1 to 100,000    source: Debevec 2005, "A Median Cut Algorithm for Light Probe Sampling"
std::vector<DirectionalLight> median_cut(const PolarMap& map, int count);

}  // namespace lightwell
