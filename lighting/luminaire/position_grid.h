// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lighting/luminaire/lamp_planes.h"

namespace lightwell {

// The square grid that a rig's positions stand on.
struct PositionGrid {
  std::array<int, 2> positions = {1, 1};  // along u, v: the box around all places
  Vec2d first_m = Vec2d::Zero();
  std::vector<std::array<int, 2>> at;  // (u, v) of every place
  std::vector<double> deviation_m;     // of every place from the grid's
};
// The grid lies where most places agree: at the mean phase along each axis. places: at least one, finite and within 2^29
// spacings of each other.
PositionGrid position_grid(std::span<const Vec2d> places_m, double spacing_m);

// Images of positions that were left out, from their neighbours along u and along v: two measured ones beside it, the mean,
// four of them, (−1, 4, 4, −1) / 6, which is exact for cubics; both axes, the mean of both.
// measured: [v][u]; what could not be completed stays false, for want of two neighbours in line.
void complete_positions(LampImages& images, std::vector<bool>& measured);

// From means over pixels to the values at their middles, which is what interpolation goes by, to fourth order.
// variance: of what was averaged over along s and t, in pixels²; of the pixels themselves 1/12
void restore_centres(LampImages& images, const Vec2d& variance);

}  // namespace lightwell
