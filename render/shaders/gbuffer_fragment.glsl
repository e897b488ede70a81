// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The small G-buffer: position and material number (from 1; 0 is background), then the shading normal as an octahedral
// pair of 16 bits, three halves of base colour from the texture and the roughness and metallic from theirs, and whether
// the surface stands in the shadow maps (0 no, 1 yes, 0.5 a support).
in vec3 world_position;
in vec3 world_normal;
in vec2 texture_uv;
uniform sampler2D base_color_map;
uniform sampler2D metallic_roughness_map;
uniform float material_number;
uniform float in_shadow_map;
layout(location = 0) out vec4 position_material;
layout(location = 1) out uvec4 surface;

// Cigolle et al. 2014.
vec2 octahedral(vec3 n) {
  vec2 p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
  if (n.z >= 0.0) return p;
  return (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
}

void main() {
  vec3 n = normalize(world_normal) * (gl_FrontFacing ? 1.0 : -1.0);
  vec3 tint = texture(base_color_map, texture_uv).rgb;
  vec4 rough = texture(metallic_roughness_map, texture_uv);
  position_material = vec4(world_position, material_number);
  surface = uvec4(packSnorm2x16(octahedral(n)), packHalf2x16(tint.rg), packHalf2x16(vec2(tint.b, rough.g)),
                  packHalf2x16(vec2(rough.b, in_shadow_map)));
}
