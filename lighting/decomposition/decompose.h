// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "lighting/light_pipeline.h"
#include "lighting/light_set.h"
#include "lighting/polar_map.h"
#include "lighting/result.h"

namespace lightwell {

// Every way to turn one map into directional lights.
enum class Method {
  best,        // the project's own (lighting/decomposition/best_lights.h)
  standard,    // row and column inversion of a Halton sequence (lighting/light_pipeline.h)
  havran,      // concentric inverse transform of a relaxed Halton sequence (lighting/light_pipeline.h)
  median_cut,  // lighting/decomposition/median_cut.h
  uniform,     // lighting/decomposition/uniform_lights.h
};
inline constexpr std::array kMethods = {Method::best, Method::standard, Method::havran, Method::median_cut,
                                        Method::uniform};
inline constexpr int kMostLights = 100000;

std::string_view name(Method method);  // as on the command line: "median-cut"
std::optional<Method> method_from_name(std::string_view name);
std::string method_names();  // "best, median-cut, …", for help and errors

// A grid that reaches far below the horizon covers the sphere, any other the hemisphere.
Coverage coverage_of(const PolarGrid& grid);

// count lights that stand for all of the map: their power sums to the map's total, a channel; with the two
// samplers, whose lights have the colour of the place they hit, only luminance does. A black map gives lights
// of no power with unit directions. map: radiance finite and ≥ 0    seed: turns the sequence or the cells
// (standard, havran, uniform); the others have none fails: usage for a count outside 1 to kMostLights;
// bad_input where the total is beyond a float
Result<LightSet> decompose(const PolarMap& map, Method method, int count, std::uint32_t seed = 0);

// The sampler of a method that has one: those whose state a LightPipeline can carry from frame to frame.
std::optional<LightPipelineOptions::Sampler> sampler_of(Method method);

}  // namespace lightwell
