// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Before shade_fragment.glsl: which pixel takes which subset of the weak lights, how it is kept for its neighbours, and what
// they make of all subsets together. Kept are, as fractions of the weak lights' illuminance, the irradiance over pi (what a
// white matt surface would return) in halves, and what the lobe returns in 9 bits a channel with a shared exponent; the
// normal as an octahedral pair of 8 bits; 24 bits of the depth, 8 of the material's number.
uniform int strong_count;
uniform vec3 weak_illuminance;  // all weak lights', and so much that its inverse is finite
uniform vec3 view_axis;                             // unit
uniform vec3 view_forward, view_right, view_up;  // a point is the eye's, and its depth times these
uniform highp usampler2D subset_map;

struct Subsets {
  vec3 diffuse, specular;
  float found;  // share of the subsets
};

const float kSharedLargest = 65408.0;  // 511/512 * 2^16
const float kScale = 1024.0;  // of fractions, so that halves and shared exponents reach far below 1

// Radiances of EXT_texture_shared_exponent.
uint pack_shared(vec3 c) {
  c = clamp(c, 0.0, kSharedLargest);
  float largest = max(max(c.r, c.g), c.b);
  int exponent = max(-16, (floatBitsToInt(largest) >> 23) - 127) + 1;
  exponent += int(largest * exp2(float(9 - exponent)) + 0.5) >> 9;
  uvec3 m = uvec3(c * exp2(float(9 - exponent)) + 0.5);
  return m.r | m.g << 9 | m.b << 18 | uint(exponent + 15) << 27;
}

vec3 unpack_shared(uint p) {
  return vec3(p & 511u, p >> 9 & 511u, p >> 18 & 511u) * exp2(float(p >> 27) - 24.0);
}

// Neighbouring pixels take lights that lie far apart in the order: as in Bayer's matrices, the bits of x ^ y and y reversed.
int subset_of(ivec2 at) {
  int across = at.x ^ at.y;
#if INTERLEAVE == 2
  return (across & 1) << 1 | (at.y & 1);
#else
  return (across & 1) << 3 | (at.y & 1) << 2 | (across & 2) | (at.y & 2) >> 1;
#endif
}

vec3 octahedron(vec2 p) {
  vec3 n = vec3(p, 1.0 - abs(p.x) - abs(p.y));
  if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
  return n;
}

uvec4 pack_subset(vec3 diffuse, vec3 specular, vec3 normal, vec3 from_eye, uint material) {
  vec3 n = normal / (abs(normal.x) + abs(normal.y) + abs(normal.z));
  if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
  uvec2 p = uvec2((n.xy * 0.5 + 0.5) * 255.0 + 0.5);
  vec3 scale = kScale / weak_illuminance;
  diffuse *= scale;
  return uvec4(packHalf2x16(diffuse.rg), packHalf2x16(vec2(diffuse.b, 0.0)) | p.x << 16 | p.y << 24,
               pack_shared(specular * scale),
               (floatBitsToUint(dot(from_eye, view_axis)) & 0xffffff00u) | (material & 255u));
}

// Each subset from the nearest pixels that hold it, on both sides where they are equally far, so that what changes evenly
// over the picture stays as it is. At the picture's border the next one inward stands for what would be outside. What lies
// across an edge is left out: another material, a normal that differs by more than SAME_NORMAL allows, a point that is off
// the surface's plane by more than SAME_PLANE pixels. The subsets that are found stand for all.
Subsets gather_subsets(ivec2 at, vec3 normal, vec3 plane, vec3 from_eye, uint material) {
  const int kReach = INTERLEAVE / 2;
  ivec2 last = textureSize(subset_map, 0) - 1;
  vec2 pixel = 2.0 / vec2(last + 1);  // in normalized device coordinates
  vec2 middle = (vec2(at) + 0.5) * pixel - 1.0;
  float depth = dot(from_eye, view_axis);
  float toward = dot(plane, view_forward + view_right * middle.x + view_up * middle.y);
  vec2 slope = vec2(dot(plane, view_right), dot(plane, view_up)) * pixel;
  float off = SAME_PLANE * depth * length(view_up) * pixel.y;
  vec3 diffuse = vec3(0.0), specular = vec3(0.0);
  float found = 0.0;
  for (int row = -kReach; row < kReach; ++row)
    for (int column = -kReach; column < kReach; ++column) {
      vec3 of_diffuse = vec3(0.0), of_specular = vec3(0.0);
      float count = 0.0;
      for (int y = row; y <= kReach; y += INTERLEAVE)
        for (int x = column; x <= kReach; x += INTERLEAVE) {
          ivec2 there = at + ivec2(x, y);
          there += INTERLEAVE * (ivec2(lessThan(there, ivec2(0))) - ivec2(greaterThan(there, last)));
          ivec2 inside = clamp(there, ivec2(0), last);
          uvec4 p = texelFetch(subset_map, inside, 0);
          vec3 n = octahedron(vec2(p.y >> 16 & 255u, p.y >> 24) * (2.0 / 255.0) - 1.0);
          float along = dot(n, normal);
          float away = uintBitsToFloat(p.w & 0xffffff00u) * (toward + dot(slope, vec2(there - at))) - depth * toward;
          bool same = there == inside && (p.w & 255u) == (material & 255u) && abs(away) <= off && along > 0.0 &&
                      along * along > SAME_NORMAL * SAME_NORMAL * dot(n, n);
          of_diffuse += same ? vec3(unpackHalf2x16(p.x), unpackHalf2x16(p.y).x) : vec3(0.0);
          of_specular += same ? unpack_shared(p.z) : vec3(0.0);
          count += same ? 1.0 : 0.0;
        }
      float share = 1.0 / max(count, 1.0);
      diffuse += of_diffuse * share;
      specular += of_specular * share;
      found += min(count, 1.0);
    }
  found /= float(INTERLEAVE * INTERLEAVE);
  vec3 scale = weak_illuminance / (kScale * max(found, 1e-6));
  return Subsets(diffuse * scale, specular * scale, found);
}
