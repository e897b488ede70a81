// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The pixels that show no surface: the environment or nothing, once a sample.
in vec2 ndc;
uniform sampler2D so_far;         // the sum of earlier lights and samples
uniform float weight;             // of this sample
uniform int start_sum;            // so_far is not there yet
uniform int show_environment;
uniform sampler2D environment;    // latitude–longitude, row 0 is the zenith
uniform float environment_turns;  // turn about +Y, in turns
uniform vec3 view_forward, view_right, view_up;
out vec4 radiance;

const float kPi = 3.14159265358979;

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

void main() {
  radiance = vec4(0.0);
  if (show_environment != 0)
    radiance = vec4(environment_radiance(normalize(view_forward + view_right * ndc.x + view_up * ndc.y)), 1.0) * weight;
  if (start_sum == 0) radiance += texelFetch(so_far, ivec2(gl_FragCoord.xy), 0);
}
