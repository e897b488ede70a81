// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/polar_cells.h"

#include <algorithm>
#include <limits>

namespace lightwell {

PolarCells::PolarCells(const PolarGrid& grid, const SpherePartition& partition)
    : grid_(grid), cell_(grid.size()), solid_angle_(static_cast<std::size_t>(partition.cells()), 0.0f) {
  for (int ring = 0; ring < grid.rings; ++ring)
    for (int sector = 0; sector < grid.sectors; ++sector) {
      const auto bin = static_cast<std::size_t>(ring) * static_cast<std::size_t>(grid.sectors) +
                       static_cast<std::size_t>(sector);
      cell_[bin] = static_cast<std::uint32_t>(partition.cell_of(grid.bin_direction(ring, sector)));
      solid_angle_[cell_[bin]] += static_cast<float>(grid.bin_solid_angle_sr(ring));
    }
}

void PolarCells::gather(const PolarMap& map, std::span<Rgb> radiance, std::span<float> finite) const {
  std::fill(radiance.begin(), radiance.end(), Rgb::Zero());
  std::fill(finite.begin(), finite.end(), 0.0f);
  const float* red = map.radiance.data();
  const float* green = map.channels == 1 ? red : red + grid_.size();
  const float* blue = map.channels == 1 ? red : green + grid_.size();
  std::size_t bin = 0;
  for (int ring = 0; ring < grid_.rings; ++ring) {
    const auto solid_angle = static_cast<float>(grid_.bin_solid_angle_sr(ring));
    for (int sector = 0; sector < grid_.sectors; ++sector, ++bin) {
      const Rgb value(red[bin], green[bin], blue[bin]);
      // NaN and infinity end here: their sum less itself is not 0.
      if (!((value - value).sum() == 0)) continue;
      radiance[cell_[bin]] += solid_angle * value.max(0.0f);
      finite[cell_[bin]] += solid_angle;
    }
  }
  for (std::size_t cell = 0; cell < radiance.size(); ++cell)
    if (finite[cell] > 0) {
      radiance[cell] /= finite[cell];
      finite[cell] /= solid_angle_[cell];
    }
}

}  // namespace lightwell
