// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lighting/polar_map.h"

namespace lightwell {

// A connected part of a map whose bins lie in one layer of luminance.
struct MapRegion {
  int layer = 0;         // 0: the darkest
  double luminance = 0;  // of its illuminance, lux
  double solid_angle_sr = 0;
  std::vector<std::uint32_t> bins;  // index in the map
};

// The lit bins of the map, cut at i · σ of the luminance (i = 1 … layers − 1, σ its standard deviation over
// solid angle about the mean) into connected regions. Bins are neighbours across their edges, across azimuth 0,
// and round a pole, where all bins of the ring meet. Order: layers from the brightest down, inside by power.
// source: Agarwal et al. 2003, section 4.1
std::vector<MapRegion> regions_by_luminance(const PolarMap& map, int layers);

}  // namespace lightwell
