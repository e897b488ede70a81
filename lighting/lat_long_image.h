// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lighting/polar_map.h"
#include "lighting/vector.h"

namespace lightwell {

// Latitude–longitude radiance image, OpenEXR convention (lighting/direction.h). Row 0 at the top.
struct LatLongImage {
  int width = 0;
  int height = 0;
  std::vector<Rgb> pixels;  // [height][width], linear Rec. 709

  [[nodiscard]] const Rgb& at(int x, int y) const {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
  [[nodiscard]] Rgb& at(int x, int y) {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
  // Exact solid angle of a pixel in row y.
  [[nodiscard]] double pixel_solid_angle_sr(int y) const;
};

// The image's own pixels as a polar map, without resampling: row y is ring y, columns run the other way round.
// Hemisphere keeps the rows above the horizon; an odd height splits its middle row there (same radiance, half its solid
// angle). rotate_y_rad turns the environment about +Y (counter-clockwise seen from above: a light at azimuth λ comes to
// λ + angle) and is rounded to whole columns only if `resample` is false; otherwise columns are split by area.
PolarMap polar_map_from_lat_long(const LatLongImage& image, bool hemisphere, double rotate_y_rad = 0);

// Area-exact resampling to another grid: every source pixel's energy is divided among the bins it overlaps.
PolarMap resample_polar(const PolarMap& map, const PolarGrid& grid);

}  // namespace lightwell
