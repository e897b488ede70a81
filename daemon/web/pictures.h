// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lighting/lat_long_image.h"
#include "lighting/polar_map.h"

namespace lightwell {

// The map as a latitude–longitude image of the whole sphere, black below the map's edge. One column a sector
// and one row a ring where the grid allows it (90 × 360 over a hemisphere: 360 × 180, without resampling).
LatLongImage lat_long_from_polar_map(const PolarMap& map);

// What the fisheye sees, for the eye: azimuth 0 (+Z) at the top, 90° (+X) at the right, the horizon on the
// circle; exposed for the map's mean, compressed (Reinhard et al. 2002, equation 4), sRGB. Black outside the
// circle. Returns [size][size][3].
std::vector<std::uint8_t> fisheye_picture(const PolarMap& map, int size);

}  // namespace lightwell
