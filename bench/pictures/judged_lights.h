// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lighting/lat_long_image.h"

// The light of the judged scenes: painted latitude–longitude images, cd/m², 512 × 256 (the sun's 1024 × 512),
// the lower half dark.
namespace lightwell::pictures {

// A blue sky with clouds and a sun of its true half degree; beam over sky's horizontal illuminance about 6, as a
// clear real one's.
LatLongImage sun_light();
// Street lamps of several colours over a dark sky.
LatLongImage night_light();
// A room with two windows whose frames divide them, a sky outside.
LatLongImage window_light();
// CIE's standard overcast sky, (1 + 2 cos θ) / 3 of the zenith's, with clouds in it.
LatLongImage overcast_light();

}  // namespace lightwell::pictures
