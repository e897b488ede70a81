// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lighting/flat_field.h"
#include "lighting/lens.h"
#include "lighting/polar_map.h"
#include "lighting/result.h"

namespace lightwell {

// What a camera's pixels received, linear: the lens's vignetting is still in it.
struct RadiancePicture {
  int width = 0;
  int height = 0;
  std::vector<float> rgb;             // [height][width][3], linear Rec. 709, cd/m², finite and ≥ 0
  std::vector<std::uint8_t> clipped;  // [height][width], 1 where the light is more than that; empty: nowhere
};

// The lens of a picture of which each pixel is the mean of a square of factor × factor pixels. A size that the factor
// does not divide is rounded up: the last squares are cut.
Lens shrunk(const Lens& lens, int factor);

// A picture as a map of three channels over grid, turned upright by the lens's zenith. For pictures once in a while, not
// for frames: each pixel's solid angle, exact, is divided among the bins it looks into, in parts that are small beside
// a bin. A bin wholly inside the field has its own solid angle and the mean radiance of its parts, so that an even sky stays
// even; one that the border of field or picture cuts has the solid angle that was seen of it. Solid angle × radiance of a
// bin is that of the pixels in it, vignetting divided out, as far as the parts fill it: half a percent or so, a few at
// the pole.
// Bins that no pixel sees are black, with solid angle 0. Of flat only the vignetting is used. Light beyond theta_max of the grid is left out.
// bad_input: the picture's size is not the lens's, no pixel sees the field, or flat does not fit the lens.
Result<PolarMap> polar_map_from_picture(const RadiancePicture& picture, const Lens& lens,
                                        const FlatField& flat, const PolarGrid& grid);

}  // namespace lightwell
