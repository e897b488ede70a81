// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Before shaders that shade: the surface that the G-buffer (gbuffer_fragment.glsl) shows at a pixel.
uniform sampler2D position_material_map;
uniform usampler2D surface_map;
uniform sampler2D materials;
uniform vec3 eye;

const float kPi = 3.14159265358979;

struct Surface {
  vec3 normal, to_eye, mirrored;
  bool phong;
  vec3 diffuse, specular;  // specular: of the lobe (Phong) or at normal incidence (metallic–roughness)
  float exponent, alpha2;
};

vec3 from_octahedral(vec2 p) {
  vec3 n = vec3(p, 1.0 - abs(p.x) - abs(p.y));
  if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
  return normalize(n);
}

Surface unpack(vec4 position_material, uvec4 packed_surface) {
  int texel = (int(position_material.w) - 1) * 2;
  vec4 a = texelFetch(materials, ivec2(texel % 1024, texel / 1024), 0);
  vec4 b = texelFetch(materials, ivec2((texel + 1) % 1024, (texel + 1) / 1024), 0);
  vec2 blue_rough = unpackHalf2x16(packed_surface.z);
  vec3 base = a.rgb * vec3(unpackHalf2x16(packed_surface.y), blue_rough.x);
  Surface s;
  s.normal = from_octahedral(unpackSnorm2x16(packed_surface.x));
  s.to_eye = normalize(eye - position_material.xyz);
  s.mirrored = reflect(-s.to_eye, s.normal);
  s.phong = a.w > 0.5;
  float metallic = b.x * float(packed_surface.w >> 2 & 255u) / 255.0;
  float rough = b.y * blue_rough.y;
  s.diffuse = s.phong ? base : base * (1.0 - metallic);
  s.specular = s.phong ? b.rgb : mix(vec3(0.04), base, metallic);
  s.exponent = b.w;
  // A mirror has no lobe that directional lights could fill: α stays above 0.001.
  s.alpha2 = max(rough * rough * rough * rough, 1e-6);
  return s;
}

// Of the triangle itself.
vec3 plane_of(uvec4 packed_surface) {
  return from_octahedral(vec2(packed_surface.w >> 10 & 2047u, packed_surface.w >> 21) * (2.0 / 2047.0) - 1.0);
}
