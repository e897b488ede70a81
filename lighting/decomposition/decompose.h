// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "lighting/decomposition/sampled_lights.h"
#include "lighting/light_pipeline.h"
#include "lighting/light_set.h"
#include "lighting/polar_map.h"
#include "lighting/result.h"

namespace lightwell {

// Every way to turn one map into directional lights. A new one is a row here, a row of the table in
// decompose.cpp, its file, and a row of the invariants that it is tested by.
enum class Method {
  best,           // the project's own (lighting/decomposition/best_lights.h)
  standard,       // row and column inversion (lighting/decomposition/sampled_lights.h)
  havran,         // concentric inverse transform (lighting/decomposition/sampled_lights.h)
  structured,     // lighting/decomposition/structured_sampling.h
  kollig_keller,  // lighting/decomposition/kollig_keller.h
  penrose,        // lighting/decomposition/penrose_sampling.h
  median_cut,     // lighting/decomposition/median_cut.h
  uniform,        // lighting/decomposition/uniform_lights.h; stays the last
};
inline constexpr auto kMethods = [] {
  std::array<Method, static_cast<std::size_t>(Method::uniform) + 1> all{};
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Method>(i);
  return all;
}();
inline constexpr int kMostLights = 100000;

std::string_view name(Method method);  // as on the command line: "median-cut"
std::optional<Method> method_from_name(std::string_view name);
std::string method_names();  // "best, standard, …", for help and errors

// The power of the lights whose directions a method chose (lighting/decomposition/cell_powers.h).
enum class Powers {
  own,    // as the method says
  cells,  // each the light of its Voronoi cell
  means,  // the same, moved to the cell's mean direction
  equal,  // all the same luminance
};

struct DecomposeOptions {
  std::uint32_t seed = 0;  // turns the sequence, the cells or the tiling (standard, havran, penrose, uniform)
  Powers powers = Powers::own;
  std::optional<Points> points;  // standard: halton (default) or random; havran: relaxed (default) or halton
  std::optional<Interpolation> interpolation;  // havran: power (default) or printed
};

// What the options come to with this method: every default filled in that applies to it.
// fails: usage, for an option that does not apply to the method
Result<DecomposeOptions> resolved(Method method, const DecomposeOptions& options);

std::string_view name(Powers powers);
std::string_view name(Points points);
std::string_view name(Interpolation interpolation);
std::optional<Powers> powers_from_name(std::string_view name);
std::optional<Points> points_from_name(std::string_view name);
std::optional<Interpolation> interpolation_from_name(std::string_view name);

// A grid that reaches far below the horizon covers the sphere, any other the hemisphere.
Coverage coverage_of(const PolarGrid& grid);

// count lights that stand for all of the map: their power sums to the map's total in every channel, directions
// lie in the map. A black map gives lights of no power with unit directions. Radiance that is negative or not
// finite counts as 0.    fails: usage for a count outside 1 to kMostLights or an option that does not apply;
// bad_input where the total is beyond a float
Result<LightSet> decompose(const PolarMap& map, Method method, int count, const DecomposeOptions& options);
Result<LightSet> decompose(const PolarMap& map, Method method, int count, std::uint32_t seed = 0);

// The sampler of a method that has one: those whose state a LightPipeline can carry from frame to frame.
std::optional<LightPipelineOptions::Sampler> sampler_of(Method method);

}  // namespace lightwell
