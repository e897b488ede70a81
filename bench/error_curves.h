// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "bench/suite.h"

namespace lightwell::bench {

// Every method and peer, 4 to 1024 lights, over all maps: the folder's real ones, else painted ones. Rows
// "error": values lights, maps, irradiance_rel_rmse and shadow_rel_rmse (geometric means over the maps), cold_ms
// (median over the maps of a first frame); the timing is that of further frames, over the maps. A method that has
// become too slow for its share of the time is left out from there on, aloud. Rows "prefix": the same errors of the
// first n of the project's own sets of 64.
std::vector<Row> error_rows(const Options& options);

// Time against lights (8 to 1024) and against pixels (90 × 360 to 720 × 2880, 64 lights) on a painted sky and sun.
// Rows "growth, lights" and "growth, pixels": values lights, pixels.
std::vector<Row> growth_rows(const Options& options);

// Plots of the lights suite: bars of its stages, and the curves of error, latency and growth.
std::vector<Figure> curve_figures(const std::vector<Row>& rows);

}  // namespace lightwell::bench
