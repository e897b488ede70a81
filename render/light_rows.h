// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lighting/light_set.h"
#include "render/casters.h"

namespace lightwell::render {

// A light as the shaders see it (std140). The rows u, v, w map a world position to its place in the light's
// own map: dot(row, (position, 1)) is in [0, 1] for every caster but the supports, w grows away from the
// light.
struct LightRow {
  float u[4];
  float v[4];
  float w[4];
  float illuminance[3];
  // Metres a unit of w stands for, the diameter of the map's sphere; negative where no support is in the
  // light's way.
  float extent_m;
};

// The diameter of a map's sphere with the depth range's padding, so that no caster reaches the cleared depth
// of 1.
inline constexpr float kDepthPadding = 1.01f;

// 256 of them fill the 16 KB that every OpenGL ES 3.1 guarantees for a uniform block.
inline constexpr int kMaxLightsPerBlock = 256;

// One row a light that has power; those that no support is in the way of come first.
// map_size: texels a side; a texel's border around the casters stays empty.
std::vector<LightRow> make_light_rows(std::span<const DirectionalLight> lights, const Casters& casters,
                                      int map_size);

}  // namespace lightwell::render
