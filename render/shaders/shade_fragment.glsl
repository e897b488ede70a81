// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Adds one block of lights to the pixels that show a surface (the depth test leaves the others out): one loop, one
// shadow look-up a light. What a loop reads of a uniform, software drivers gather pixel by pixel: more than half of the
// loop's work. So it derives the map's axes, and takes everything else from before it.
// LIGHT_PASS: WHOLE draws all lights; SUBSETS a pixel's subset of the weak ones (interleave.glsl); FILTERED the strong ones,
// and what the subsets of the neighbourhood make of the weak; where that is too little, all.
struct Light { vec4 to_light_extent, illuminance_texel, tile_blur, fit; };  // LightRow
layout(std140) uniform Lights { Light lights[256]; };
uniform int light_count;
uniform vec3 objects_centre, scene_centre;  // of the spheres that maps fit, without supports in the way and with
uniform highp sampler2D shadow_maps;  // depths, as they are
uniform float atlas_side;              // texels
uniform sampler2D position_material_map;
uniform usampler2D surface_map;
uniform sampler2D materials;
uniform vec3 eye;
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

// glTF 2.0, appendix B.3: Trowbridge–Reitz distribution, Smith masking, Schlick's Fresnel term.
vec3 metallic_roughness(Surface s, vec3 to_light, float cosine) {
  vec3 h = to_light + s.to_eye;
  h *= inversesqrt(max(dot(h, h), 1e-12));  // a light exactly behind has none
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
  float along = dot(s.mirrored, to_light);
  float lobe = along > 0.0 || s.exponent == 0.0 ? pow(max(along, 1e-8), s.exponent) : 0.0;
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

struct Maps {
  vec3 from_objects, from_scene;  // to the surface
  float bias;                     // 0 where the surface does not stand in the maps, else 1
  bool behind_support;
  vec3 plane;  // normal of the triangle itself
};

// 1 lit, 0 in shadow, between them what bilinear weights of the nearest four texels make of them. Outside its map
// everything is lit. The axes are map_rows's.
float visibility(Maps maps, vec4 tile_blur, vec4 fit, float texel, vec3 to_light, float extent) {
  float size = abs(extent);
  // Each texel is compared with the depth that the surface's own plane has there, not with that of the point: so no
  // slope needs a bias. The rest (CASTER_SLACK, in texels along the normal) is for casters simpler than what is seen.
  vec3 p = (extent > 0.0 ? maps.from_scene : maps.from_objects) + maps.plane * (maps.bias * tile_blur.w * CASTER_SLACK);
  vec3 u = abs(to_light.y) < 0.9 ? vec3(to_light.z, 0.0, -to_light.x) : vec3(0.0, -to_light.z, to_light.y);
  u *= inversesqrt(dot(u, u));
  vec3 v = cross(to_light, u);
  vec2 place = vec2(dot(u, p), dot(v, p)) * fit.xy + fit.zw;
  vec2 inside = clamp(place, 0.5 * texel, 1.0 - 0.5 * texel);
  vec2 at = (tile_blur.xy + inside * tile_blur.z) * atlas_side - 0.5;
  vec2 corner = floor(at);
  vec2 part = at - corner;
  vec4 depths = textureGather(shadow_maps, (corner + 1.0) / atlas_side);
  float depth = 0.5 - dot(to_light, p) / size - DEPTH_SLACK;
  float cosine = max(dot(maps.plane, to_light), LEAST_COSINE);
  vec2 slope = vec2(dot(u, maps.plane), dot(v, maps.plane)) * texel / (fit.xy * (size * cosine)) * maps.bias;
  vec2 low = -part * slope, high = low + slope;
  vec4 plane = depth + vec4(low.x, high.x, high.x, low.x) + vec4(high.y, high.y, low.y, low.y);
  vec4 lit4 = step(min(plane, 1.0), depths);
  vec2 row = mix(lit4.wx, lit4.zy, part.x);
  float lit = mix(row.x, row.y, part.y);
  // The side of a support that a light behind it sees: nothing of the scene is on that side.
  return inside == place && !(maps.behind_support && extent > 0.0) ? lit : 1.0;
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 position_material = texelFetch(position_material_map, at, 0);
  uvec4 packed_surface = texelFetch(surface_map, at, 0);
  Surface s = unpack(position_material, packed_surface);
  uint in_shadow_maps = packed_surface.w & 3u;
  Maps maps;
  maps.from_objects = position_material.xyz - objects_centre;
  maps.from_scene = position_material.xyz - scene_centre;
  maps.bias = in_shadow_maps == 1u ? 1.0 : 0.0;
  maps.behind_support = in_shadow_maps == 2u;
  maps.plane = from_octahedral(vec2(packed_surface.w >> 10 & 2047u, packed_surface.w >> 21) * (2.0 / 2047.0) - 1.0);
  int first = 0, step = 1, end = light_count;
  vec3 sum = vec3(0.0);
#if LIGHT_PASS == SUBSETS
  first = strong_count + subset_of(at);
  step = INTERLEAVE * INTERLEAVE;
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
  Subsets weak = gather_subsets(at, s.normal, maps.plane, position_material.xyz - eye, uint(position_material.w));
  bool wide = s.phong ? s.exponent <= WIDEST_EXPONENT : s.alpha2 >= LEAST_ALPHA2;
  if (weak.found >= LEAST_FOUND && (wide || s.specular == vec3(0.0))) {
    end = strong_count;
    sum += s.diffuse * weak.diffuse + weak.specular;
  }
#endif
  for (int i = first; i < end; i += step) {
    vec4 to_light_extent = lights[i].to_light_extent;
    vec4 light = lights[i].illuminance_texel;
    vec3 to_light = to_light_extent.xyz;
    float cosine = max(dot(s.normal, to_light), 0.0);
#if HAS_SHADOWS
    light.rgb *= visibility(maps, lights[i].tile_blur, lights[i].fit, light.w, to_light, to_light_extent.w);
#endif
#if LIGHT_PASS == SUBSETS
    vec3 of_lobe = reflectance(lobe, to_light, cosine);
    sum += light.rgb * cosine * of_lobe;
    matt_sum += light.rgb * cosine * (reflectance(matt, to_light, cosine) - of_lobe);
#else
    sum += light.rgb * cosine * reflectance(s, to_light, cosine);
#endif
  }
#if LIGHT_PASS == SUBSETS
  subset = pack_subset(matt_sum, sum, s.normal, position_material.xyz - eye, uint(position_material.w));
#else
  radiance = vec4(sum, coverage) * weight;
  if (start_sum == 0) radiance += texelFetch(so_far, at, 0);
#endif
}
