// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lighting/light_set.h"
#include "lighting/polar_map.h"

// Lights drawn from the map as from a distribution, all of equal luminance: one map by itself (for frames in a row
// see lighting/light_pipeline.h).
namespace lightwell {

// Where the points of the unit square come from.
enum class Points {
  random,   // independent, from the seed
  halton,   // Halton's sequence in bases 2 and 3
  relaxed,  // the same, moved apart by Lloyd's relaxation on the torus
};

// How Havran's transform interpolates the azimuth's distribution between rings (lighting/sampling/ring_sampling.h).
enum class Interpolation { power, printed };

// Row, then column. source: Pharr and Humphreys 2004    count: 1 to 100,000    seed: turns the sequence
std::vector<DirectionalLight> standard_lights(const PolarMap& map, int count, Points points,
                                              std::uint32_t seed);

// Concentric inverse transform. source: Havran et al. 2005, section 3
std::vector<DirectionalLight> havran_lights(const PolarMap& map, int count, Points points,
                                            Interpolation interpolation, std::uint32_t seed);

}  // namespace lightwell
