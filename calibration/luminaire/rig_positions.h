// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "interface/rig_file.h"
#include "lighting/luminaire/position_grid.h"

namespace lightwell::calibration {

// A position whose pictures are all there is measured: a whole one, or the parts that the filter's two slides let through.
struct RigPositions {
  PositionGrid grid;
  std::vector<bool> measured;    // [v][u]
  double largest_deviation = 0;  // of a position from the grid, in spacings
};

// bad_input: a position off the grid, twice, with one part alone, or a tenth or more of the grid left out; names line and
// deviation.
Result<RigPositions> rig_positions(const Rig& rig, const std::filesystem::path& folder);

}  // namespace lightwell::calibration
