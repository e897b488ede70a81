// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lighting/field/sphere_partition.h"
#include "lighting/polar_map.h"

namespace lightwell {

// Gathers the bins of polar maps of one grid into the cells of a partition of the sphere, each bin into the cell that
// holds its centre: no light is lost or counted twice.
class PolarCells {
 public:
  PolarCells(const PolarGrid& grid, const SpherePartition& partition);

  [[nodiscard]] const PolarGrid& grid() const { return grid_; }
  // Of the partition: how much of each cell a map of this grid shows. [cells], sr
  [[nodiscard]] std::span<const float> solid_angle_sr() const { return solid_angle_; }
  [[nodiscard]] std::uint32_t cell_of(std::size_t bin) const { return cell_[bin]; }
  // Mean radiance of what is finite in each cell, 0 where there is none, and what part of the shown cell is finite (0 to 1).
  // Values below 0 count as 0. radiance, finite: [cells].
  void gather(const PolarMap& map, std::span<Rgb> radiance, std::span<float> finite) const;

 private:
  PolarGrid grid_;
  std::vector<std::uint32_t> cell_;  // [bins]
  std::vector<float> solid_angle_;   // [cells]
};

}  // namespace lightwell
