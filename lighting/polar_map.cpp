// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/polar_map.h"

namespace lightwell {

PolarMap PolarMap::make(const PolarGrid& grid, int channels) {
  PolarMap map;
  map.grid = grid;
  map.channels = channels;
  const std::size_t bins = grid.size();
  map.radiance.assign(bins * static_cast<std::size_t>(channels), 0.0f);
  map.peak = map.radiance;
  map.clipped.assign(bins, 0);
  map.solid_angle_sr.resize(bins);
  std::size_t bin = 0;
  for (int ring = 0; ring < grid.rings; ++ring) {
    const auto omega = static_cast<float>(grid.bin_solid_angle_sr(ring));
    for (int sector = 0; sector < grid.sectors; ++sector) map.solid_angle_sr[bin++] = omega;
  }
  map.coverage = static_cast<float>((1 - std::cos(grid.theta_max_rad)) / 2);
  return map;
}

Rgbd total_illuminance(const PolarMap& map) {
  Rgbd total = Rgbd::Zero();
  for (int c = 0; c < map.channels; ++c) {
    const auto plane = map.plane(c);
    const auto size = static_cast<Eigen::Index>(plane.size());
    const double sum = (Eigen::Map<const Eigen::ArrayXf>(plane.data(), size).cast<double>() *
                        Eigen::Map<const Eigen::ArrayXf>(map.solid_angle_sr.data(), size).cast<double>())
                           .sum();
    if (map.channels == 1) return Rgbd::Constant(sum);
    total[c] = sum;
  }
  return total;
}

}  // namespace lightwell
