// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lighting/field/field_grid.h"
#include "lighting/vector.h"

namespace lightwell {

// The sphere cut into cells of equal area and small diameter: two polar caps and collars of equal cells about +Y.
// source: Leopardi 2006, "A partition of the unit sphere into regions of equal area and small diameter"
class SpherePartition {
 public:
  explicit SpherePartition(int cells);  // at least 2

  [[nodiscard]] int cells() const { return first_.back(); }
  [[nodiscard]] double cell_solid_angle_sr() const { return 4 * kPi / cells(); }
  // Side of a square of a cell's area, radians.
  [[nodiscard]] double cell_width_rad() const;
  // direction: unit. The one cell that holds it, 0 at the zenith.
  [[nodiscard]] int cell_of(const Vec3d& direction) const;
  // Middle of a cell by area: half of it lies above, half of it to each side; a pole for a cap.
  [[nodiscard]] Vec3d centre(int cell) const;

 private:
  std::vector<int> first_;  // [collars + 1]: a collar's first cell; caps are collars of one cell
};

inline constexpr int kMostFieldDirections = 1 << 20;

// Cells for a field: neighbouring rays drift by about two grid cells over the whole grid, or, where it is a corridor, over
// four times its second longest side, for few rays run farther in it. Never so few that they would tell in degree 8, nor
// more than kMostFieldDirections.
int direction_count_for(const FieldGrid& grid);

}  // namespace lightwell
