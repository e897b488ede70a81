// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/field_grid_option.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "cli/command.h"
#include "cli/number_list.h"

namespace lightwell::cli {
namespace {

constexpr double kFinestCell_m = 1e-6;  // of 100 km doubles still tell a ten-thousandth of it

}  // namespace

Result<FieldGrid> field_grid(const std::string& given_size, const std::string& given_bounds) {
  FieldGrid grid;
  const auto size = number_list(given_size, 3);
  const auto whole = [](double n) { return n == std::floor(n) && n >= 2 && n <= kMostFieldSide; };
  if (!size || !std::all_of(size->begin(), size->end(), whole))
    return usage("--grid is " + given_size + ", allowed: NX,NY,NZ, whole numbers from 2 to " +
                 std::to_string(kMostFieldSide));
  const auto bounds = number_list(given_bounds, 6);
  if (!bounds)
    return usage("--bounds is " + given_bounds + ", allowed: X0,Y0,Z0,X1,Y1,Z1, six numbers in metres");
  for (std::size_t a = 0; a < 3; ++a) {
    grid.size[a] = static_cast<int>((*size)[a]);
    const auto axis = static_cast<Eigen::Index>(a);
    grid.low[axis] = (*bounds)[a];
    grid.high[axis] = (*bounds)[a + 3];
    if (!(grid.high[axis] > grid.low[axis]) || !(std::abs(grid.low[axis]) <= 1e5) ||
        !(std::abs(grid.high[axis]) <= 1e5))
      return usage("--bounds is " + given_bounds +
                   ", allowed: X0 < X1, Y0 < Y1, Z0 < Z1, -100000 to 100000 metres");
  }
  if (const double cell = grid.cell().minCoeff(); !(cell >= kFinestCell_m)) {
    char text[100];
    std::snprintf(text, sizeof text, ": points %g metres apart, allowed: %g or more", cell, kFinestCell_m);
    return usage("--bounds is " + given_bounds + text);
  }
  if (grid.points() > kMostFieldPoints)
    return usage("--grid is " + given_size + ": " + std::to_string(grid.points()) +
                 " points, allowed: up to " + std::to_string(kMostFieldPoints) + ", 512 cubed");
  return grid;
}

}  // namespace lightwell::cli
