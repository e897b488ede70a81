// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lighting/decomposition/lit_bins.h"
#include "lighting/decomposition/voronoi_cells.h"
#include "lighting/light_set.h"
#include "lighting/polar_map.h"

// Powers for lights whose directions are chosen. Any way to choose them can be combined with any of these; all sum
// to the map's total in every channel.
namespace lightwell {

// Each light gets the light of its Voronoi cell: of the bins to which it is the nearest (of equally near ones
// the first). source: Kollig and Keller 2003; Agarwal et al. 2003
void set_cell_powers(const PolarMap& map, std::span<DirectionalLight> lights);

// The same, and each light moves to the luminance-weighted mean of its cell: one step of Lloyd's relaxation. A light
// without a cell stays.
void set_cell_means(const PolarMap& map, std::span<DirectionalLight> lights);

// A light for each place of the cells, at its cell's mean with its light. bins: of the map
std::vector<DirectionalLight> lights_at_means(const PolarMap& map, const LitBins& bins,
                                              const VoronoiCells& cells);

// count lights: those at the places with the power of their cells, then dark ones beside the first.
// bins: of the map; at least one place
std::vector<DirectionalLight> lights_of_cells(const PolarMap& map, const LitBins& bins,
                                              std::span<const Vec3d> places, std::size_t count);

// Each light keeps its colour and gets the same luminance; a light without power has the map's mean colour.
// Then each channel is scaled to the map's total: by 4 at most (a channel that the lights hardly have would
// come out in one of them), what is missing then is spread evenly.
void set_equal_powers(const PolarMap& map, std::span<DirectionalLight> lights);

}  // namespace lightwell
