// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

namespace lightwell::bench {

// Speed against error of drawing lights from a 90 × 360 RGB map, with the peers in the same run:
// {"stages": [{"name", "p50_us", "p99_us", "max_us"}],                       300 lights, a sun that moves
//  "sampling": [{"method", "lights", "p50_us", "p99_us", "lights_per_ms",
//                "irradiance_rel_rmse", "shadow_rel_rmse"}]}                 mean over the maps
// Methods: havran, standard (ours); printed (Havran's as published), row_column (double, binary search, one
// light at a time), random (the same with random points). Times do not hold the cumulative sums, which stand
// among the stages. frames: repetitions of every measurement.
nlohmann::ordered_json lights_suite(int frames = 500);

}  // namespace lightwell::bench
