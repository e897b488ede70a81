// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lighting/light_set.h"
#include "render/casters.h"

namespace lightwell::render {

// A light as the shaders see it (std140).
struct LightRow {
  float to_light[3];  // unit
  // Metres that a map's depth covers, the diameter of the sphere it fits; negative where no support is in the light's
  // way, and the sphere is the objects'.
  float extent_m;
  float illuminance[3];
  float texel;    // 1 / side of the light's map, texels
  float tile[3];  // the map in the atlas: corner and side, of the atlas's side
  float spread;   // tangent of the light's angular radius
  // From metres along the map's axes, from the sphere's centre, to the map's square: scales, then offsets.
  float fit[4];
};

// Of its illuminance.
double luminance_of(const LightRow& light);

// The diameter of a map's sphere with the depth range's padding, so that no caster reaches the cleared depth
// of 1.
inline constexpr float kDepthPadding = 1.01f;

// 16 KB of them, what every OpenGL ES 3.1 guarantees for a uniform block.
inline constexpr int kMaxLightsPerBlock = 256;

// One row a light that has power, in the lights' order, without a map yet.
std::vector<LightRow> make_light_rows(std::span<const DirectionalLight> lights, const Casters& casters);

// Fits a map of so many texels a side to what casts, as the light sees it: the objects' rectangle, or where a support is
// in the light's way the scene's sphere. Sets texel and fit. drawn: the meshes that the map will show
void fit_map(LightRow& light, const Casters& drawn, int side);

// Affine maps of world positions for a light's map: dot(row, (position, 1)) is in [0, 1] for every caster but the
// supports, with a border of two texels in u and v; w grows away from the light.
struct MapRows {
  float u[4], v[4], w[4];
};
MapRows map_rows(const LightRow& light, const Casters& casters);

}  // namespace lightwell::render
