// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lighting/light_set.h"
#include "lighting/polar_map.h"

namespace lightwell {

// Hierarchical importance sampling with blue noise. The map's cap is laid on the unit disc without change of
// area (Lambert), the disc on a Penrose tiling (lighting/decomposition/robinson_tiling.h), which is divided where
// there is light until each vertex whose rank is below (a scale) · (the map's radiance at the vertex) is found;
// lights stand at those. The scale is the one at which there are exactly `count`: they are the vertices of
// least rank / radiance, found best first with bounds on both, so no scale is searched for. All lights have
// equal luminance and the colour of the bin they hit; power is the map's own in every channel.
//
// Left out of the paper: its table of shifts by which vertices are moved apart, relaxed beforehand for each
// neighbourhood in the tiling and each fraction of a level. Order: by rank / radiance, so the set of n is the
// beginning of the set of n + 1. A map of whole-sphere coverage is stretched towards the nadir.
//
// seed: turns the tiling; 0: not at all.    count: 1 to 100,000
// source: Ostromoukhov, Donohue and Jodoin 2004, "Fast Hierarchical Importance Sampling with Blue Noise
// Properties"
std::vector<DirectionalLight> penrose_sampling(const PolarMap& map, int count, std::uint32_t seed);

}  // namespace lightwell
