// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Adds a lamp to the pixels that show a surface (the depth test leaves the others out): each of its sources is a point with
// an image of what it sends into every direction, and a shadow map (Granier et al. 2003, equation 14). In the lamp's frame.
// SOURCE_MAP: PLANE, HEMISPHERE, SPHERE (lamp_sources.h). FACES: of the shadow maps (lamp_views.h).
struct Source { vec4 place_low, fit; };  // x and y of its place, tangents at its image's corner; its shadow map
layout(std140) uniform Sources { Source sources[256]; };
uniform int source_count;
uniform float place_z;  // of all sources
uniform float source_radius;
uniform mat3 lamp_from_world;
uniform vec3 lamp_origin, lamp_middle;  // world; of the sources, lamp's frame
uniform highp sampler2DArray images;
uniform vec3 candela;            // of the images' 1
uniform vec2 per_span;           // 1 / tangents over an image
uniform float image_pixels;      // in a tangent, or in a radian, of 1
uniform float pixel_tangent;     // the picture's: width of what a pixel shows at a metre
uniform mat3 map_from_lamp;
uniform sampler2D so_far;  // the sum of earlier lights and samples
uniform float weight;      // of this sample
out vec4 radiance;

// Where a direction is in an image, [0, 1]². way: not 0
vec2 place_in_image(vec3 way, float per_metre, vec2 low) {
#if SOURCE_MAP == PLANE
  return (way.xy / max(-way.z, 1e-6) - low) * per_span;
#elif SOURCE_MAP == HEMISPHERE
  // Shirley and Chiu 1997, as square_from_direction().
  float radius = sqrt(clamp(1.0 + way.z * per_metre, 0.0, 1.0));
  vec2 size = abs(way.xy);
  bool beside = size.x >= size.y;
  float part = atan(beside ? way.y : way.x, max(beside ? size.x : size.y, 1e-30)) * (4.0 / kPi);
  vec2 square = beside ? vec2(way.x < 0.0 ? -1.0 : 1.0, part) : vec2(part, way.y < 0.0 ? -1.0 : 1.0);
  return radius * square * 0.5 + 0.5;
#else
  vec2 nodes = vec2(textureSize(images, 0).xy);
  float around = atan(way.y, way.x) * (0.5 / kPi);
  float down = acos(clamp(-way.z * per_metre, -1.0, 1.0)) / kPi;
  return vec2(around + 0.5 / nodes.x, (down * (nodes.y - 1.0) + 0.5) / nodes.y);
#endif
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 position_material = texelFetch(position_material_map, pixel, 0);
  uvec4 packed_surface = texelFetch(surface_map, pixel, 0);
  Surface s = unpack(position_material, packed_surface);
  vec3 at = lamp_from_world * (position_material.xyz - lamp_origin);
  // What a pixel shows of the surface, of the light's images as they fall on it: the level of pixels as wide, between two.
  float seen = length(eye - position_material.xyz) * pixel_tangent *
               inversesqrt(max(abs(dot(s.normal, s.to_eye)), 0.05));
  s.normal = lamp_from_world * s.normal;
  s.to_eye = lamp_from_world * s.to_eye;
  s.mirrored = lamp_from_world * s.mirrored;
#if SOURCE_MAP == PLANE
  float away = max(place_z - at.z, 1e-6);
#else
  float away = max(length(at - lamp_middle), 1e-6);
#endif
  float level = log2(max(seen * image_pixels / away, 1.0));
#if HAS_SHADOWS
  vec3 plane = map_from_lamp * (lamp_from_world * plane_of(packed_surface));
  uint in_shadow_maps = packed_surface.w & 3u;
  float biased = in_shadow_maps == 1u ? 1.0 : 0.0;
  bool behind_support = in_shadow_maps == 2u;  // nothing of the scene is on that side
#endif
  vec3 sum = vec3(0.0);
  for (int i = 0; i < source_count; ++i) {
    vec4 place_low = sources[i].place_low;
    vec3 way = at - vec3(place_low.xy, place_z);
    float per_metre = inversesqrt(max(dot(way, way), 1e-8));
    vec3 to_light = -way * per_metre;
    float cosine = max(dot(s.normal, to_light), 0.0);
    vec2 place = place_in_image(way, per_metre, place_low.zw);
    vec3 light = textureLod(images, vec3(place, float(i)), level).rgb * (cosine * per_metre * per_metre);
#if SOURCE_MAP != SPHERE
    bool lit = way.z < 0.0;
#if SOURCE_MAP == PLANE
    vec2 off = abs(place - 0.5);
    lit = lit && max(off.x, off.y) <= 0.5;
#endif
    light = lit ? light : vec3(0.0);
#endif
#if HAS_SHADOWS
    if (!behind_support) light *= lamp_visibility(map_from_lamp * way, plane, biased, sources[i].fit, i * FACES);
#endif
    sum += light * reflectance(s, to_light, cosine, source_radius * per_metre);
  }
  // Images that were freed of blur may be negative here and there: light is not.
  radiance = vec4(max(sum * candela, vec3(0.0)) * weight, 0.0) + texelFetch(so_far, pixel, 0);
}
