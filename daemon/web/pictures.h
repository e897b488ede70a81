// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lighting/polar_map.h"

namespace lightwell {

// What the fisheye sees, for the eye: azimuth 0 (+Z) at the top, 90° (+X) at the right, the horizon on the
// circle; exposed for the map's mean, compressed (Reinhard et al. 2002, equation 4), sRGB. Black outside the
// circle. Returns [size][size][3].
std::vector<std::uint8_t> fisheye_picture(const PolarMap& map, int size);

}  // namespace lightwell
