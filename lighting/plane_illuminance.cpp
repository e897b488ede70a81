// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/plane_illuminance.h"

#include <algorithm>

namespace lightwell {

Rgbd plane_illuminance(const PolarMap& map, const Vec3d& normal) {
  Rgbd sum = Rgbd::Zero();
  std::size_t bin = 0;
  for (int ring = 0; ring < map.grid.rings; ++ring)
    for (int sector = 0; sector < map.grid.sectors; ++sector, ++bin) {
      const double cosine = std::max(0.0, normal.dot(map.grid.bin_direction(ring, sector)));
      if (cosine > 0) sum += map.rgb(bin).cast<double>() * (cosine * map.solid_angle_sr[bin]);
    }
  return sum;
}

}  // namespace lightwell
