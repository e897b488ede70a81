// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// How much of a light a surface sees, by the light's map: before shade_fragment.glsl. A light is an even disc of an angular
// radius; percentage-closer soft shadows (Fernando 2005) find how far off what covers it is, and so how wide the edge. A
// light that is small beside the map's texels takes one look-up.
uniform float casters_off_texels;  // from where the maps show them, at most

struct Maps {
  vec3 from_objects, from_scene;  // to the surface
  float bias;                     // 0 where the surface does not stand in the maps, else 1
  bool behind_support;
  vec3 plane;  // normal of the triangle itself
};

// Search: what casts may be near, which takes looks near the middle, or far. Filter: evenly over a disc (Vogel 1979).
const int kLooks = 12;
const vec3 kSearch[kLooks] = vec3[](vec3(0.0400, 0.0000, 0.0400), vec3(-0.0395, 0.0362, 0.0536), vec3(0.0063, -0.0715, 0.0718), vec3(0.0586, 0.0764, 0.0962), vec3(-0.1270, -0.0225, 0.1289), vec3(0.1458, -0.0927, 0.1728), vec3(-0.0601, 0.2236, 0.2315), vec3(-0.1430, -0.2753, 0.3102), vec3(0.3904, 0.1426, 0.4157), vec3(-0.5148, 0.2125, 0.5570), vec3(0.3163, -0.6760, 0.7463), vec3(0.2993, 0.9542, 1.0000));  // z: length
const vec2 kFilter[kLooks] = vec2[](vec2(0.2041, 0.0000), vec2(-0.2607, 0.2388), vec2(0.0399, -0.4547), vec2(0.3286, 0.4286), vec2(-0.6030, -0.1067), vec2(0.5712, -0.3634), vec2(-0.1911, 0.7107), vec2(-0.3644, -0.7016), vec2(0.7906, 0.2887), vec2(-0.8224, 0.3395), vec2(0.3965, -0.8472), vec2(0.2930, 0.9341));

// reach: of the map's square, for a metre toward the light, to the edge of the light's disc; slack: metres toward the light
// in which the disc widens by a texel
float soft_visibility(BeforeMap b, vec2 reach, vec3 to_light, float size, float slack) {
  // Every light has the pattern turned another way, so that what it misses differs.
  float turn = 97.0 * dot(to_light, vec3(1.0, 1.3, 1.7));
  mat2 turned = mat2(cos(turn), sin(turn), -sin(turn), cos(turn));
  float front = b.depth * size;  // metres to the front of the map
  float heights = 0.0, blockers = 0.0;
  for (int k = 0; k < kLooks; ++k) {
    Texels t = texels_at(b, b.place + reach * (turned * kSearch[k].xy) * front);
    vec4 height = (b.depth - t.depths) * size;
    // What is nearer than where the cone to the light's disc is so wide does not cover it.
    vec4 blocks = (1.0 - step(t.planes, t.depths)) * step(vec4(front * kSearch[k].z), height + slack);
    heights += t.inside ? dot(blocks, max(height, 0.0)) : 0.0;
    blockers += t.inside ? dot(blocks, vec4(1.0)) : 0.0;
  }
  float radius = heights / max(blockers, 1.0);
  // An edge as sharp as the map is.
  if (radius * min(reach.x, reach.y) < b.texel) return lit_at(b, b.place);
  float sum = 0.0;
  for (int k = 0; k < kLooks; ++k) sum += lit_at(b, b.place - reach * (turned * kFilter[k]) * radius);
  return sum / float(kLooks);
}

// The axes are map_rows's.
float visibility(Maps maps, vec4 tile_spread, vec4 fit, float texel, vec3 to_light, float extent) {
  // The side of a support that a light behind it sees: nothing of the scene is on that side.
  if (maps.behind_support && extent > 0.0) return 1.0;
  float size = abs(extent);
  float blur = texel / min(fit.x, fit.y);  // of the map's larger texel side, metres
  // CASTER_SLACK, in texels along the normal, is for casters simpler than what is seen.
  vec3 p = (extent > 0.0 ? maps.from_scene : maps.from_objects) + maps.plane * (maps.bias * blur * (CASTER_SLACK + casters_off_texels));
  vec3 u = abs(to_light.y) < 0.9 ? vec3(to_light.z, 0.0, -to_light.x) : vec3(0.0, -to_light.z, to_light.y);
  u *= inversesqrt(dot(u, u));
  vec3 v = cross(to_light, u);
  BeforeMap b;
  b.place = vec2(dot(u, p), dot(v, p)) * fit.xy + fit.zw;
  b.depth = 0.5 - dot(to_light, p) / size - DEPTH_SLACK;
  float cosine = max(dot(maps.plane, to_light), LEAST_COSINE);
  b.slope = vec2(dot(u, maps.plane), dot(v, maps.plane)) / (fit.xy * (size * cosine)) * maps.bias;
  b.tile = tile_spread.xyz;
  b.texel = texel;
#if SOFT_EDGES
  // Beyond it twelve looks are too far apart to know a shadow by.
  float spread = min(tile_spread.w, 0.25);
  if (spread * b.depth * size >= blur) return soft_visibility(b, fit.xy * spread, to_light, size, blur / spread);
#endif
  return lit_at(b, b.place);
}
