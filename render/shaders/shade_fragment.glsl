// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Adds one block of lights to the pixels that show a surface (the depth test leaves the others out): one loop, one
// shadow look-up a light. What a loop reads of a uniform, software drivers gather pixel by pixel: more than half of the
// loop's work. So it derives the map's axes, and takes everything else from before it.
// LIGHT_PASS: WHOLE draws all lights; SUBSETS a pixel's subset of the weak ones (interleave.glsl); FILTERED the strong ones,
// and what the subsets of the neighbourhood make of the weak; where that is too little, all.
struct Light { vec4 to_light_extent, illuminance_texel, tile_spread, fit; };  // LightRow
layout(std140) uniform Lights { Light lights[256]; };
uniform int light_count;
uniform vec3 objects_centre, scene_centre;  // of the spheres that maps fit, without supports in the way and with
#if LIGHT_PASS == SUBSETS
out uvec4 subset;
#else
uniform sampler2D so_far;   // the sum of earlier lights and samples
uniform float weight;       // of this sample
uniform float coverage;     // once a sample, as ambient light
uniform int start_sum;      // so_far is not there yet
uniform vec3 ambient;
#if HAS_EMISSION
uniform sampler2D emission_map;
#endif
out vec4 radiance;
#endif

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 position_material = texelFetch(position_material_map, at, 0);
  uvec4 packed_surface = texelFetch(surface_map, at, 0);
  Surface s = unpack(position_material, packed_surface);
  vec3 plane = plane_of(packed_surface);
#if HAS_SHADOWS
  uint in_shadow_maps = packed_surface.w & 3u;
  Maps maps = Maps(position_material.xyz - objects_centre, position_material.xyz - scene_centre,
                   in_shadow_maps == 1u ? 1.0 : 0.0, in_shadow_maps == 2u, plane);
#endif
  // Of the lights, or of the entries that list them.
  int first = 0, step = 1, end = light_count;
#if LIGHT_LISTS
  int cell = cell_of(s.normal);
  first = LISTED;
  end = LISTED + list_entry(0, cell);
#endif
  vec3 sum = vec3(0.0);
#if LIGHT_PASS == SUBSETS
#if LIGHT_LISTS
  int begins = 2 + subset_of(at);
  first = GROUPED + list_entry(begins, cell);
  end = GROUPED + list_entry(begins + 1, cell);
#else
  first = strong_count + subset_of(at);
  step = INTERLEAVE * INTERLEAVE;
#endif
  // What the surface's colour makes of it is the filter's to say: so a pattern on a surface is no edge.
  Surface lobe = s, matt = s;
  lobe.diffuse = vec3(0.0);
  matt.diffuse = vec3(1.0);
  vec3 matt_sum = vec3(0.0);
#else
  // Ambient light reaches every surface: albedo times radiance. A lobe's albedo is taken at normal incidence.
  sum = (s.diffuse + s.specular) * ambient * coverage;
#if HAS_EMISSION
  sum += texelFetch(emission_map, at, 0).rgb * coverage;
#endif
#endif
#if LIGHT_PASS == FILTERED
  Subsets weak = gather_subsets(at, s.normal, plane, position_material.xyz - eye, uint(position_material.w));
  bool wide = s.phong ? s.exponent <= WIDEST_EXPONENT : s.alpha2 >= LEAST_ALPHA2;
  if (weak.found >= LEAST_FOUND && (wide || s.specular == vec3(0.0))) {
#if LIGHT_LISTS
    end = LISTED + list_entry(1, cell);
#else
    end = strong_count;
#endif
    sum += s.diffuse * weak.diffuse + weak.specular;
  }
#endif
  for (int k = first; k < end; k += step) {
#if LIGHT_LISTS
    int i = list_entry(k, cell);
#else
    int i = k;
#endif
    vec4 to_light_extent = lights[i].to_light_extent;
    vec4 light = lights[i].illuminance_texel;
    vec3 to_light = to_light_extent.xyz;
    float cosine = max(dot(s.normal, to_light), 0.0);
    vec4 tile_spread = lights[i].tile_spread;
    float spread = tile_spread.w;
#if HAS_SHADOWS
    light.rgb *= visibility(maps, tile_spread, lights[i].fit, light.w, to_light, to_light_extent.w);
#endif
#if LIGHT_PASS == SUBSETS
    vec3 of_lobe = reflectance(lobe, to_light, cosine, spread);
    sum += light.rgb * cosine * of_lobe;
    matt_sum += light.rgb * cosine * (reflectance(matt, to_light, cosine, spread) - of_lobe);
#else
    sum += light.rgb * cosine * reflectance(s, to_light, cosine, spread);
#endif
  }
#if LIGHT_PASS == SUBSETS
  subset = pack_subset(matt_sum, sum, s.normal, position_material.xyz - eye, uint(position_material.w));
#else
  radiance = vec4(sum, coverage) * weight;
  if (start_sum == 0) radiance += texelFetch(so_far, at, 0);
#endif
}
