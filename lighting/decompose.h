// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "lighting/light_set.h"
#include "lighting/polar_map.h"
#include "lighting/result.h"

namespace lightwell {

// Every way to turn one map into directional lights.
enum class Method { best, median_cut, uniform };
inline constexpr std::array kMethods = {Method::best, Method::median_cut, Method::uniform};
inline constexpr int kMostLights = 100000;

std::string_view name(Method method);  // as on the command line: "median-cut"
std::optional<Method> method_from_name(std::string_view name);
std::string method_names();  // "best, median-cut, …", for help and errors

// A grid that reaches far below the horizon covers the sphere, any other the hemisphere.
Coverage coverage_of(const PolarGrid& grid);

// count lights that stand for all of the map: their power sums to the map's total, a channel. A black map
// gives lights of no power with unit directions. map: radiance finite and ≥ 0    seed: where the method draws
// points (uniform); the others ignore it fails: usage for a count outside 1 to kMostLights; bad_input where
// the total is beyond a float
Result<LightSet> decompose(const PolarMap& map, Method method, int count, std::uint32_t seed = 0);

}  // namespace lightwell
