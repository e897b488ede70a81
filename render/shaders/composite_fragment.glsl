// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// One sample of objects over the plate; where a surface only receives shadows, the plate times the ratio of light with
// the objects to light without them, a colour each. Beside the picture, what of it the plate is.
in vec2 ndc;
uniform sampler2D so_far;  // the sums of earlier samples
uniform sampler2D share_so_far;
uniform sampler2D shadowed_map;
uniform sampler2D unshadowed_map;
uniform usampler2D surface_map;
uniform sampler2D plate_map;  // row 0 at the top
uniform float white;          // radiance of the plate's 1
uniform float weight;         // of this sample
uniform int start_sum;        // so_far is not there yet
layout(location = 0) out vec4 radiance;
layout(location = 1) out vec4 plate_share;  // in the plate's own values; a: what objects cover

// Bilinear by hand: float textures need not filter. Of the picture's own size, its own pixel exactly.
vec3 plate() {
  ivec2 size = textureSize(plate_map, 0);
  vec2 place = (gl_FragCoord.xy / vec2(textureSize(shadowed_map, 0)));
  place = vec2(place.x, 1.0 - place.y) * vec2(size) - 0.5;
  // Rounding must not mix neighbours where pixels meet exactly.
  vec2 nearest = round(place);
  if (all(lessThan(abs(place - nearest), vec2(1e-3)))) place = nearest;
  ivec2 corner = ivec2(floor(place));
  vec2 f = place - vec2(corner);
  vec3 sum = vec3(0.0);
  for (int k = 0; k < 4; ++k) {
    ivec2 step = ivec2(k & 1, k >> 1);
    vec2 share = mix(1.0 - f, f, vec2(step));
    sum += texelFetch(plate_map, clamp(corner + step, ivec2(0), size - 1), 0).rgb * share.x * share.y;
  }
  return sum;
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 shadowed = texelFetch(shadowed_map, at, 0);
  vec3 behind = plate() * (1.0 - shadowed.a);
  float covered = shadowed.a;
  vec3 object = shadowed.rgb;
  if (shadowed.a > 0.0 && (texelFetch(surface_map, at, 0).w & 3u) == 0u) {
    vec3 without = texelFetch(unshadowed_map, at, 0).rgb;
    vec3 ratio = min(shadowed.rgb / max(without, 1e-37), 1.0);
    behind = plate() * mix(vec3(1.0), ratio, greaterThan(without, vec3(1e-37)));
    covered = 0.0;
    object = vec3(0.0);
  }
  radiance = vec4(object + behind * white, 1.0) * weight;
  plate_share = vec4(behind, covered) * weight;
  if (start_sum != 0) return;
  radiance += texelFetch(so_far, at, 0);
  plate_share += texelFetch(share_so_far, at, 0);
}
