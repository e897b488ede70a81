// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lighting/light_set.h"
#include "lighting/polar_map.h"

namespace lightwell {

inline constexpr int kMostPlacedLights = 512;

// The project's own static decomposition: N weighted directions of least energy distance to the map, in
// progressive order with parents. Atoms of the map → two starts by weighted k-means (one drawn to what is
// bright) → descent of each on the energy distance, the better is kept → non-negative powers a channel →
// powers nudged to the map's Lambertian moments → split tree. Power sums to the map's total a channel.
// Deterministic. Above kMostPlacedLights the descent costs more than it gains: there the lights are median
// cut's (lighting/decomposition/median_cut.h). A map of fewer lit atoms than lights gives a light each and the rest without
// power. count: 1 to 100,000; lights stay within theta_max of the map's grid
std::vector<DirectionalLight> best_lights(const PolarMap& map, int count);

}  // namespace lightwell
