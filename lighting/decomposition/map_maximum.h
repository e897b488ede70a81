// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lighting/polar_map.h"

namespace lightwell {

// An upper bound of values over any rectangle of rings and sectors in at most 18 look-ups: maxima over cells of
// 2^i rings by 2^j sectors, for all i and j (a rip-map). The bound is the maximum over the cells that the
// rectangle touches, less than twice as wide and high as it is.
class MapMaximum {
 public:
  // values: [rings][sectors], ≥ 0
  MapMaximum(const PolarGrid& grid, std::vector<double> values);

  // Rings ring0 to ring1, inclusive, in the grid; sectors from sector0 on, 1 to all of them, round azimuth 0.
  [[nodiscard]] double bound(int ring0, int ring1, int sector0, int sectors) const;
  [[nodiscard]] double value(int ring, int sector) const;

 private:
  struct Level {
    std::size_t columns;
    std::vector<double> most;
  };
  [[nodiscard]] double in_rectangle(int ring0, int ring1, int sector0, int sector1) const;

  PolarGrid grid_;
  std::size_t sector_levels_ = 0;
  std::vector<Level> levels_;  // [ring level][sector level]
};

}  // namespace lightwell
