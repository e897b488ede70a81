// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// A look-up in a tile of a depth texture, for lights far away (shadow.glsl) and near (lamp_shadow.glsl).
uniform highp sampler2D shadow_maps;  // depths, as they are
uniform float atlas_side;              // texels

// A point before a light's map, in the map's square [0, 1]² and its depth.
struct BeforeMap {
  vec2 place;
  float depth;
  vec2 slope;  // of the depth of the surface's own plane
  vec3 tile;
  float texel;
};

// The four texels around a place: which of them, and where between.
struct Texels {
  vec4 depths, planes;  // of the map, of the surface's own plane
  vec2 part;
  bool inside;
};

// Each texel is compared with the depth that the surface's own plane has there, not with that of the point: so no slope
// needs a bias.
Texels texels_at(BeforeMap b, vec2 place) {
  vec2 inside = clamp(place, 0.5 * b.texel, 1.0 - 0.5 * b.texel);
  vec2 at = (b.tile.xy + inside * b.tile.z) * atlas_side - 0.5;
  vec2 corner = floor(at);
  vec2 part = at - corner;
  vec2 step_up = b.slope * b.texel;
  vec2 low = -part * step_up, high = low + step_up;
  float depth = b.depth + dot(inside - b.place, b.slope);
  vec4 planes = depth + vec4(low.x, high.x, high.x, low.x) + vec4(high.y, high.y, low.y, low.y);
  return Texels(textureGather(shadow_maps, (corner + 1.0) / atlas_side), min(planes, 1.0), part, inside == place);
}

// 1 lit, 0 in shadow, between them what bilinear weights of the texels make of them. Outside its map everything is lit.
float lit_at(BeforeMap b, vec2 place) {
  Texels t = texels_at(b, place);
  vec4 lit = step(t.planes, t.depths);
  vec2 row = mix(lit.wx, lit.zy, t.part.x);
  return t.inside ? mix(row.x, row.y, t.part.y) : 1.0;
}
