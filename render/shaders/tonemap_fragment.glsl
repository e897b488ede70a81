// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Linear radiance to sRGB. Reinhard et al. 2002, eq. 4, on luminance; operator 0 only clamps.
in vec2 ndc;
uniform sampler2D radiance_map;
uniform int reinhard;
uniform float scale;          // key / log-average luminance
uniform float white_squared;  // smallest scaled luminance that becomes white, squared
uniform int straight_alpha;
out vec4 color;

vec3 srgb(vec3 c) {
  c = clamp(c, 0.0, 1.0);
  return mix(12.92 * c, 1.055 * pow(max(c, 1e-6), vec3(1.0 / 2.4)) - 0.055, greaterThan(c, vec3(0.0031308)));
}

void main() {
  vec4 value = texelFetch(radiance_map, ivec2(gl_FragCoord.xy), 0);
  vec3 c = value.rgb;
  if (straight_alpha != 0 && value.a > 0.0) c /= value.a;
  if (reinhard != 0) {
    float l = dot(c, vec3(0.2126, 0.7152, 0.0722)) * scale;
    c *= scale * (1.0 + l / white_squared) / (1.0 + l);
  }
  color = vec4(srgb(c), value.a);
}
