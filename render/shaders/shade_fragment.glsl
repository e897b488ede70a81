// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Adds one block of lights to the picture: one loop, one shadow look-up a light.
in vec2 ndc;
struct Light { vec4 u, v, w, illuminance; };
layout(std140) uniform Lights { Light lights[256]; };
uniform int light_count;
uniform int tiles;
uniform float map_size;
uniform int has_shadows;
uniform sampler2DShadow shadow_maps;
uniform sampler2D position_material_map;
uniform usampler2D surface_map;
uniform sampler2D materials;
uniform sampler2D so_far;        // the sum of earlier blocks and samples
uniform float weight;            // of this sample
uniform int first_block;         // ambient, background and coverage count once a sample
uniform int start_sum;           // so_far is not there yet
uniform vec3 eye;
uniform vec3 ambient;
uniform int show_environment;
uniform sampler2D environment;   // latitude–longitude, row 0 is the zenith
uniform float environment_turns; // turn about +Y, in turns
uniform vec3 view_forward, view_right, view_up;
out vec4 radiance;

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

// Bilinear by hand: float textures need not filter.
vec3 environment_radiance(vec3 d) {
  ivec2 size = textureSize(environment, 0);
  float azimuth = atan(d.x, d.z) / (2.0 * kPi) - environment_turns;
  vec2 place = vec2(fract(0.5 - azimuth), acos(clamp(d.y, -1.0, 1.0)) / kPi) * vec2(size) - 0.5;
  ivec2 corner = ivec2(floor(place));
  vec2 f = place - vec2(corner);
  vec3 sum = vec3(0.0);
  for (int k = 0; k < 4; ++k) {
    ivec2 step = ivec2(k & 1, k >> 1);
    ivec2 at = corner + step;
    at = ivec2((at.x + size.x) % size.x, clamp(at.y, 0, size.y - 1));
    vec2 share = mix(1.0 - f, f, vec2(step));
    sum += texelFetch(environment, at, 0).rgb * share.x * share.y;
  }
  return sum;
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
  float metallic = b.x * unpackHalf2x16(packed_surface.w).x;
  float rough = b.y * blue_rough.y;
  s.diffuse = s.phong ? base : base * (1.0 - metallic);
  s.specular = s.phong ? b.rgb : mix(vec3(0.04), base, metallic);
  s.exponent = b.w;
  // A mirror has no lobe that directional lights could fill: α stays above 0.001.
  s.alpha2 = max(rough * rough * rough * rough, 1e-6);
  return s;
}

// glTF 2.0, appendix B.3: Trowbridge–Reitz distribution, Smith masking, Schlick's Fresnel term.
vec3 metallic_roughness(Surface s, vec3 to_light, float cosine) {
  vec3 h = normalize(to_light + s.to_eye);
  float nv = max(dot(s.normal, s.to_eye), 1e-4);
  float nh = max(dot(s.normal, h), 0.0);
  float vh = max(dot(s.to_eye, h), 0.0);
  float t = nh * nh * (s.alpha2 - 1.0) + 1.0;
  float distribution = s.alpha2 / (kPi * t * t);
  float visibility = 0.5 / (cosine * sqrt(s.alpha2 + (1.0 - s.alpha2) * nv * nv) +
                            nv * sqrt(s.alpha2 + (1.0 - s.alpha2) * cosine * cosine));
  vec3 fresnel = s.specular + (1.0 - s.specular) * pow(1.0 - min(vh, 1.0), 5.0);
  return (1.0 - fresnel) * s.diffuse / kPi + fresnel * distribution * visibility;
}

vec3 phong(Surface s, vec3 to_light) {
  float lobe = pow(max(dot(s.mirrored, to_light), 1e-8), s.exponent);
  return s.diffuse / kPi + s.specular * ((s.exponent + 2.0) / (2.0 * kPi) * lobe);
}

vec3 reflectance(Surface s, vec3 to_light, float cosine) {
#if HAS_PHONG && HAS_METALLIC_ROUGHNESS
  return s.phong ? phong(s, to_light) : metallic_roughness(s, to_light, cosine);
#elif HAS_PHONG
  return phong(s, to_light);
#else
  return metallic_roughness(s, to_light, cosine);
#endif
}

// 1 lit, 0 in shadow, between them the hardware's 2×2 comparison. Outside its map everything is lit.
float visibility(int i, vec2 tile, vec3 position, Surface s, vec3 to_light, float cosine, float in_shadow_map) {
  float extent = abs(lights[i].illuminance.w);
  // The side of a support that a light behind it sees: nothing of the scene is on that side.
  if (in_shadow_map == 0.5 && lights[i].illuminance.w > 0.0) return 1.0;
  bool stands_in_map = in_shadow_map == 1.0;
  // A 2×2 comparison reaches √2 texels away, where a plane at angle θ to the light is nearer by √2·texel·tan θ. Moving
  // the point by √2·texel·sin θ along its normal clears exactly that; the rest is for depth's 16 bits and curvature.
  float texel = extent / (map_size - 4.0);
  float bias = stands_in_map ? texel * (1.4142136 * sqrt(max(1.0 - cosine * cosine, 0.0)) + 0.1) : 0.0;
  vec4 p = vec4(position + s.normal * bias, 1.0);
  vec3 place = vec3(dot(lights[i].u, p), dot(lights[i].v, p), dot(lights[i].w, p));
  vec2 inside = clamp(place.xy, 0.5 / map_size, 1.0 - 0.5 / map_size);
  float lit = textureLod(shadow_maps, vec3((tile + inside) / float(tiles), min(place.z, 1.0)), 0.0);
  return inside == place.xy ? lit : 1.0;
}

vec3 reflected(vec4 position_material, uvec4 packed_surface) {
  Surface s = unpack(position_material, packed_surface);
  float in_shadow_map = unpackHalf2x16(packed_surface.w).y;
  vec3 sum = vec3(0.0);
  vec2 tile = vec2(-1.0, 0.0);
  for (int i = 0; i < light_count; ++i) {
    tile = tile.x + 1.0 == float(tiles) ? vec2(0.0, tile.y + 1.0) : vec2(tile.x + 1.0, tile.y);
    vec3 to_light = lights[i].w.xyz * -abs(lights[i].illuminance.w);
    float cosine = dot(s.normal, to_light);
    if (cosine <= 0.0) continue;
    vec3 light = lights[i].illuminance.rgb * cosine;
    if (has_shadows != 0) light *= visibility(i, tile, position_material.xyz, s, to_light, cosine, in_shadow_map);
    sum += light * reflectance(s, to_light, cosine);
  }
  // Ambient light reaches every surface: albedo times radiance. A lobe's albedo is taken at normal incidence.
  if (first_block != 0) sum += (s.diffuse + s.specular) * ambient;
  return sum;
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 position_material = texelFetch(position_material_map, at, 0);
  vec4 now = vec4(0.0);
  if (position_material.w > 0.0) {
    now = vec4(reflected(position_material, texelFetch(surface_map, at, 0)), first_block != 0 ? 1.0 : 0.0);
  } else if (first_block != 0 && show_environment != 0) {
    now = vec4(environment_radiance(normalize(view_forward + view_right * ndc.x + view_up * ndc.y)), 1.0);
  }
  radiance = now * weight;
  if (start_sum == 0) radiance += texelFetch(so_far, at, 0);
}
