// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "lighting/vector.h"

namespace lightwell {

// A directional light. Returns ρ/π · illuminance · max(0, n·direction) from a Lambertian surface of albedo ρ.
struct DirectionalLight {
  Vec3f direction = Vec3f::UnitY();  // unit, from the scene toward the light
  Rgb illuminance = Rgb::Zero();     // lux on a surface that faces the light
  std::int32_t parent = -1;          // index of an earlier light, where the whole set is a tree; else -1
  std::uint32_t id = 0;              // the same light carries the same id from frame to frame
  // Relative RMSE of shadows (lighting/evaluation/evaluate.h) predicted for a reader that takes the lights up to this
  // one; 0: not predicted
  float predicted_error = 0;
  // Of an even disc as wide as what the light stands for (lighting/second_moment.h): shadows have an edge
  // so soft, highlights are so much wider; 0: a point, or not known
  float angular_radius_rad = 0;
};

enum class Coverage { hemisphere, sphere };

// Lights in progressive order: a reader takes a prefix and rescales by total power, or folds children into parents
// where every light but the first has one.
struct LightSet {
  std::string method;
  Coverage coverage = Coverage::hemisphere;
  Rgb total_illuminance = Rgb::Zero();  // lux, summed over directions, of the map the lights stand for
  std::vector<DirectionalLight> lights;
  bool has_parents = false;
  Rgb ambient = Rgb::Zero();  // radiance from everywhere, cd/m²
};

// The first count lights of a progressive set standing for all of it: folded into parents where there are parents,
// else the prefix rescaled, per channel, to the power of all the set's lights (a channel that is dark in the prefix is
// spread by luminance, evenly where that is dark too). count ≥ size returns the set; total and ambient stay.
LightSet take_lights(const LightSet& set, std::size_t count);

}  // namespace lightwell
