// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lighting/light_set.h"
#include "lighting/polar_map.h"

namespace lightwell {

// The cap of the map divided into `count` cells of equal solid angle (zones of equal-area cells, Leopardi
// 2006); a light stands in the middle of each with the power of the bins whose centres lie in it. Knows
// nothing of where light comes from: what the other methods are to be better than. Order: base-2 radical
// inverse, any prefix is spread out. seed: turns the cells about +Y; 0: not at all.    count: 1 to 100,000
std::vector<DirectionalLight> uniform_lights(const PolarMap& map, int count, std::uint32_t seed);

// What a black map is decomposed into by methods that go where light is: lights of no power in the middles of
// equal cells.
std::vector<DirectionalLight> dark_lights(const PolarGrid& grid, int count);

}  // namespace lightwell
