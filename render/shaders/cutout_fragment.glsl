// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The holes of a caster, as the G-buffer has them.
in vec2 texture_uv;
in float vertex_alpha;
uniform sampler2D base_color_map;
uniform vec3 base_color_uv[2];
uniform float alpha;
uniform float alpha_cutoff;

void main() {
  vec3 uv = vec3(texture_uv, 1.0);
  float base = texture(base_color_map, vec2(dot(base_color_uv[0], uv), dot(base_color_uv[1], uv))).a;
  if (base * vertex_alpha * alpha < alpha_cutoff) discard;
}
