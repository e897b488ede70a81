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
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
  [[nodiscard]] Rgb& at(int x, int y) {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
  // Exact solid angle of a pixel in row y.
  [[nodiscard]] double pixel_solid_angle_sr(int y) const;
};

// The image's own pixels as a polar map of three channels, without resampling: row y is ring y, columns run the other
// way round. Where the sphere's own lines fall inside pixels, all pixels are halved, same radiance on both halves: an
// odd width gives twice the sectors (sector 0 begins at azimuth 0), an odd height in a hemisphere as many rings as rows.
// rotate_y_rad turns the environment about +Y: a light at azimuth λ comes to λ + angle. Whole columns are moved exactly;
// for any other angle each column is divided between two by area, which keeps the energy.
// image: finite, ≥ 0, at least 1×1
PolarMap polar_map_from_lat_long(const LatLongImage& image, bool hemisphere, double rotate_y_rad = 0);

// Area-exact resampling to another grid: every source bin's illuminance is divided among the bins it overlaps by area,
// so the total is kept to float rounding where the grid covers the map; light beyond theta_max of the grid is left out.
// Bins of the grid beyond the map carry their nearest radiance and solid angle 0.
PolarMap resample_polar(const PolarMap& map, const PolarGrid& grid);

// The map as an image of the whole sphere, black below the map's edge. One column a sector and one row a ring where the
// grid allows it (90 × 360 over a hemisphere: 360 × 180, without resampling), else resampled by area.
LatLongImage lat_long_from_polar_map(const PolarMap& map);

// A map of the whole sphere (theta_max π, an even number of sectors) of which a part was seen: a pixel has its bin's
// illuminance over the bin's own solid angle. It is black where nothing was seen, and the image's sum is the map's.
LatLongImage lat_long_of_measured(const PolarMap& map);

}  // namespace lightwell
