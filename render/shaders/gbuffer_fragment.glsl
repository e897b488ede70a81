// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The small G-buffer: position and material number (from 1; 0 is background), then the shading normal as an octahedral
// pair of 16 bits, three halves of base colour from texture and vertex and the roughness from its texture; where the scene
// has such, emitted radiance. The last word of the surface: 2 bits of how it stands in the shadow maps (0 not, 1 it casts,
// 2 a support seen from behind, 3 from its front), 8 of metallic, and the normal of its plane as an octahedral pair of 11.
// HAS_DETAIL: textures, vertex colours, holes.
in vec3 world_position;
in vec3 world_normal;
uniform float material_number;
uniform float in_shadow_map;
layout(location = 0) out vec4 position_material;
layout(location = 1) out uvec4 surface;
#if HAS_EMISSION
layout(location = 2) out vec4 emitted;
uniform vec3 emission;
#endif

#if HAS_DETAIL
in vec2 texture_uv;
in vec4 vertex_color;
uniform sampler2D base_color_map;
uniform sampler2D metallic_roughness_map;
uniform sampler2D normal_map;
uniform sampler2D emission_map;
// From the vertices' coordinates to each texture's: two rows.
uniform vec3 base_color_uv[2];
uniform vec3 metallic_roughness_uv[2];
uniform vec3 normal_uv[2];
uniform vec3 emission_uv[2];
uniform float normal_scale;  // 0: no normal map
uniform float alpha;
uniform float alpha_cutoff;

vec2 place(vec3 rows[2]) {
  vec3 uv = vec3(texture_uv, 1.0);
  return vec2(dot(rows[0], uv), dot(rows[1], uv));
}

// Tangents from the way that position and texture coordinates change over the picture (Schüler 2013), so that moving
// meshes need none. n faces the viewer; seen from behind, the map's normals are reversed as a whole (glTF 2.0, 3.9.4).
vec3 mapped_normal(vec3 n, float side) {
  vec2 uv = place(normal_uv);
  vec3 map = texture(normal_map, uv).xyz * 2.0 - 1.0;
  vec3 across_y = cross(dFdy(world_position), n);
  vec3 across_x = cross(n, dFdx(world_position));
  vec2 uv_dx = dFdx(uv);
  vec2 uv_dy = dFdy(uv);
  vec3 along_u = across_y * uv_dx.x + across_x * uv_dy.x;
  vec3 along_v = across_y * uv_dx.y + across_x * uv_dy.y;
  // Lengths that are small, as of a scene of micrometres, must not vanish when squared.
  float longest = max(max(abs(along_u.x), abs(along_u.y)), abs(along_u.z));
  longest = max(longest, max(max(abs(along_v.x), abs(along_v.y)), abs(along_v.z)));
  if (!(longest > 0.0)) return n;  // texture coordinates that stand still
  along_u /= longest;
  along_v /= longest;
  float size = side * normal_scale * inversesqrt(max(dot(along_u, along_u), dot(along_v, along_v)));
  // Green is up, v points down.
  return normalize(along_u * (size * map.x) - along_v * (size * map.y) + n * map.z);
}
#endif

// Cigolle et al. 2014.
vec2 octahedral(vec3 n) {
  vec2 p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
  if (n.z >= 0.0) return p;
  return (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
}

// Of the triangle itself, toward the side that is seen; shadow maps are compared with this plane.
uint plane_normal(vec3 n) {
  vec3 along_x = dFdx(world_position), along_y = dFdy(world_position);
  float longest = max(max(abs(along_x.x), abs(along_x.y)), abs(along_x.z));
  longest = max(longest, max(max(abs(along_y.x), abs(along_y.y)), abs(along_y.z)));
  vec3 plane = longest > 0.0 ? cross(along_x / longest, along_y / longest) : n;
  if (!(dot(plane, plane) > 0.0)) plane = n;
  uvec2 p = uvec2((octahedral(normalize(plane) * (dot(plane, n) < 0.0 ? -1.0 : 1.0)) * 0.5 + 0.5) * 2047.0 + 0.5);
  return p.x << 10 | p.y << 21;
}

void main() {
  float side = gl_FrontFacing ? 1.0 : -1.0;
  vec3 n = normalize(world_normal) * side;
  vec3 tint = vec3(1.0);
  vec2 rough_metallic = vec2(1.0);
  uint maps = plane_normal(n) | (in_shadow_map == 0.5 ? (gl_FrontFacing ? 3u : 2u) : uint(in_shadow_map));
#if HAS_DETAIL
  vec4 base = texture(base_color_map, place(base_color_uv)) * vertex_color;
  rough_metallic = texture(metallic_roughness_map, place(metallic_roughness_uv)).gb;
  vec3 glow = texture(emission_map, place(emission_uv)).rgb;
  if (normal_scale != 0.0) n = mapped_normal(n, side);
  // Last, for derivatives are taken with the neighbours that are holes.
  if (base.a * alpha < alpha_cutoff) discard;
  tint = base.rgb;
#endif
  position_material = vec4(world_position, material_number);
  surface = uvec4(packSnorm2x16(octahedral(n)), packHalf2x16(tint.rg), packHalf2x16(vec2(tint.b, rough_metallic.x)),
                  maps | uint(clamp(rough_metallic.y, 0.0, 1.0) * 255.0 + 0.5) << 2);
#if HAS_EMISSION
  vec3 light = emission;
#if HAS_DETAIL
  light *= glow;
#endif
  emitted = vec4(light, 0.0);
#endif
}
