// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "lighting/lat_long_image.h"
#include "lighting/polar_map.h"

namespace lightwell {

// Polar maps of a probe as pictures of the world: latitude–longitude images whose pixels are as large as the map's bins,
// NaN where the probe did not look. For one thread: keeps scratch memory.
class WorldPicture {
 public:
  // grid: rings of whole pixels (θmax / rings divides π), an even number of sectors. seen: [grid.size()], whether the probe
  // sees a bin at all; one that it sees may still be without a pixel of its own.
  WorldPicture(const PolarGrid& grid, std::vector<bool> seen);

  // The probe as it stands in the world's frame: every bin is a pixel.
  void paint_upright(const PolarMap& map, LatLongImage& out) const;
  // Turned: every measured bin is cut into four, and a pixel has the mean radiance, by solid angle, of the pieces that
  // fall into it; that of the bin in its middle where none does.
  void paint(const PolarMap& map, const Eigen::Quaterniond& world_from_probe, LatLongImage& out);

 private:
  [[nodiscard]] Rgb seen_toward(const PolarMap& map, const Vec3d& direction) const;  // probe; NaN: not seen
  PolarGrid grid_;
  std::vector<bool> seen_;
  int width_, height_;
  std::vector<Vec3d> pieces_;          // [bins][4] directions, probe
  std::vector<float> solid_angle_sr_;  // [height][width]
};

}  // namespace lightwell
