// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Light of a field on the pixels that show a surface (the depth test leaves the others out). Where something stands before a
// main light, what that light gives of the same harmonics is taken away: nothing else changes, and nothing at all where all
// main lights are seen.
struct Light { vec4 to_light_extent, illuminance_texel, tile_spread, fit; };  // LightRow
layout(std140) uniform Lights { Light lights[256]; };
uniform int light_count;
uniform int main_light[8];                  // which one each of the lights is
uniform vec3 objects_centre, scene_centre;  // of the spheres that maps fit, without supports in the way and with
uniform sampler2D so_far;                   // the sum of earlier lights and samples
uniform float weight;                       // of this sample
uniform float coverage;                     // once a sample, as the field
uniform int start_sum;                      // so_far is not there yet
uniform int last_block;
uniform vec3 grid_low, grid_per_metre, grid_last, texture_size;  // texture_size: texels
uniform float field_scale;
#if HAS_EMISSION
uniform sampler2D emission_map;
#endif
#if HAS_LOBES
uniform sampler2DArray lobe_table;  // lobe_tables.h
#endif
out vec4 radiance;

// What the surface gathers, with light by bands: matt · Σ of_normal[l] N_l + Σ (base · of_axis[l] + edge[l]) A_l, where N_l
// and A_l are the bands in the direction of the normal and of the lobe's axis.
struct Gathering {
  vec3 matt, base, axis;
  float of_edge;  // 1, or 0 where there is no Fresnel term
  float of_normal[BANDS], of_axis[BANDS], edge[BANDS];
};

#if HAS_LOBES
vec4 looked_up[LOBE_LAYERS];
float entry(int i) { return looked_up[i >> 2][i & 3]; }
#endif

Gathering gathering(Surface s) {
  Gathering g;
  g.matt = s.diffuse;
  g.base = vec3(0.0);
  g.axis = s.normal;
  g.of_edge = 0.0;
  for (int l = 0; l < BANDS; ++l) {
    g.of_normal[l] = kIrradiance[l] / kPi;
    g.of_axis[l] = 0.0;
    g.edge[l] = 0.0;
  }
#if HAS_LOBES
  // 0⁰ is 1: a lobe without an exponent is even in all directions.
  if (s.phong && s.exponent == 0.0) {
    g.matt += s.specular;
    return g;
  }
  float cosine = clamp(dot(s.normal, s.to_eye), 0.0, 1.0);
  float number = s.phong ? s.exponent / (s.exponent + EXPONENT_MIDDLE) : sqrt(sqrt(s.alpha2));
  vec2 at = (vec2(number, cosine) * (LOBE_STEPS - 1.0) + 0.5) / LOBE_STEPS;
  float layer = s.phong ? 0.0 : ROUGH_LAYER;
  for (int i = 0; i < LOBE_LAYERS; ++i) looked_up[i] = texture(lobe_table, vec3(at, layer + float(i)));
  g.axis = normalize(mix(s.mirrored, s.normal, entry(0)));
  g.base = s.specular;
  for (int l = 0; l < BANDS; ++l) g.of_axis[l] = entry(1 + l);
#if HAS_METALLIC_ROUGHNESS
  if (!s.phong) {
    g.matt = s.diffuse * (1.0 - s.specular);
    g.of_edge = 1.0;
    for (int l = 0; l < BANDS; ++l) {
      g.edge[l] = entry(1 + BANDS + l);
      g.of_normal[l] = entry(1 + 2 * BANDS + l);
    }
  }
#endif
#endif
  return g;
}

vec3 of_field(Gathering g, vec3 normal) {
  vec3 b[BANDS];
  bands_of_irradiance(normal, b);
  vec3 matt = vec3(0.0);
  for (int l = 0; l < BANDS; ++l) matt += g.of_normal[l] * b[l];
  vec3 sum = g.matt * matt;
#if HAS_LOBES
  bands(g.axis, b);
  vec3 lobe = vec3(0.0), edge = vec3(0.0);
  for (int l = 0; l < BANDS; ++l) {
    lobe += g.of_axis[l] * b[l];
    edge += g.edge[l] * b[l];
  }
  sum += g.base * lobe + g.of_edge * edge;
#endif
  return sum;
}

// The same of a light of illuminance 1. Of bands that of_field() leaves out of the matt part, so is it here.
vec3 of_light(Gathering g, vec3 normal, vec3 to_light) {
  float b[BANDS];
  bands_of_light(dot(normal, to_light), b);
  float matt = 0.0;
  for (int l = 0; l < BANDS; ++l) matt += kIrradiance[l] == 0.0 ? 0.0 : g.of_normal[l] * b[l];
  vec3 sum = g.matt * matt;
#if HAS_LOBES
  bands_of_light(dot(g.axis, to_light), b);
  float lobe = 0.0, edge = 0.0;
  for (int l = 0; l < BANDS; ++l) {
    lobe += g.of_axis[l] * b[l];
    edge += g.edge[l] * b[l];
  }
  sum += g.base * lobe + g.of_edge * edge;
#endif
  return sum;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 position_material = texelFetch(position_material_map, pixel, 0);
  uvec4 packed_surface = texelFetch(surface_map, pixel, 0);
  Surface s = unpack(position_material, packed_surface);
  // Beyond the bounds the light is that of the nearest place within.
  vec3 texel = clamp((position_material.xyz - grid_low) * grid_per_metre, vec3(0.0), grid_last);
  fetch_field((texel + 0.5) / texture_size);
  Gathering g = gathering(s);
  vec3 sum = coverage * of_field(g, s.normal);
#if HAS_SHADOWS && MAIN_LIGHTS > 0
  vec3 plane = plane_of(packed_surface);
  uint in_shadow_maps = packed_surface.w & 3u;
  Maps maps = Maps(position_material.xyz - objects_centre, position_material.xyz - scene_centre,
                   in_shadow_maps == 1u ? 1.0 : 0.0, in_shadow_maps == 2u, plane);
  for (int i = 0; i < light_count; ++i) {
    vec3 to_light = lights[i].to_light_extent.xyz;
    float lit = visibility(maps, lights[i].tile_spread, lights[i].fit, lights[i].illuminance_texel.w, to_light,
                           lights[i].to_light_extent.w);
    sum -= (1.0 - lit) * light_here(main_light[i]) * of_light(g, s.normal, to_light);
  }
#endif
  sum *= field_scale;
#if HAS_EMISSION
  sum += texelFetch(emission_map, pixel, 0).rgb * coverage;
#endif
  radiance = vec4(sum, coverage) * weight;
  if (start_sum == 0) radiance += texelFetch(so_far, pixel, 0);
  // Harmonics of few bands are negative where they ring: light is not.
  if (last_block != 0) radiance.rgb = max(radiance.rgb, vec3(0.0));
}
