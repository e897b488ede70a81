// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Linear radiance to the codes of a display. Reinhard et al. 2002, eq. 4, on luminance above a knee; without it only
// clamped; or luminance as false colour, with a legend in the upper right corner. A graded plate keeps its own values.
in vec2 ndc;
uniform sampler2D radiance_map;
uniform int reinhard;
uniform float scale;          // of radiance, before the operator
uniform float knee;           // scaled luminance up to which the operator leaves all as it is
uniform float white_squared;  // smallest scaled luminance that becomes white: (white - knee) / (1 - knee), squared
uniform int over_plate;       // plate_share holds a graded plate
uniform sampler2D plate_share;  // what of the picture the plate is, in display light; a: what objects cover
uniform float plate_white;    // radiance that the picture has for the plate's 1
uniform int straight_alpha;
uniform int display;          // 0 sRGB, 1 Rec. 709, 2 linear
uniform int false_colour;
uniform sampler2D colours;    // one row, over a logarithmic scale
uniform float scale_low, scale_high;  // its bounds, binary logarithms of luminance
uniform sampler2D legend;     // row 0 at the top
uniform ivec2 legend_size;    // 0: none
uniform int picture_height;
out vec4 color;

// IEC 61966-2-1.
vec3 srgb(vec3 c) {
  return mix(12.92 * c, 1.055 * pow(max(c, 1e-6), vec3(1.0 / 2.4)) - 0.055, greaterThan(c, vec3(0.0031308)));
}

// ITU-R BT.709, item 1.2.
vec3 rec709(vec3 c) {
  return mix(4.5 * c, 1.099 * pow(max(c, 1e-6), vec3(0.45)) - 0.099, greaterThanEqual(c, vec3(0.018)));
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 value = texelFetch(radiance_map, at, 0);
  vec3 c = value.rgb;
  if (straight_alpha != 0 && value.a > 0.0) c /= value.a;
  float luminance = dot(c, vec3(0.2126, 0.7152, 0.0722));
  if (false_colour != 0) {
    int last = textureSize(colours, 0).x - 1;
    float place = (log2(max(luminance, 1e-30)) - scale_low) / (scale_high - scale_low);
    c = texelFetch(colours, ivec2(clamp(int(place * float(last + 1)), 0, last), 0), 0).rgb;
    if (place < 0.0) c = vec3(0.0);
    if (place > 1.0) c = vec3(1.0);
    ivec2 in_legend = ivec2(at.x - textureSize(radiance_map, 0).x + legend_size.x, picture_height - 1 - at.y);
    if (in_legend.x >= 0 && in_legend.y < legend_size.y) {
      color = vec4(texelFetch(legend, in_legend, 0).rgb, 1.0);
      return;
    }
    color = vec4(c, value.a);
    return;
  }
  vec4 plate = vec4(0.0, 0.0, 0.0, 1.0);
  if (over_plate != 0) {
    plate = texelFetch(plate_share, at, 0);
    c = max(c - plate.rgb * plate_white, 0.0) / max(plate.a, 1e-6);
    luminance = dot(c, vec3(0.2126, 0.7152, 0.0722));
  }
  c *= scale;
  float l = luminance * scale;
  if (reinhard != 0 && l > knee) {
    float above = (l - knee) / (1.0 - knee);
    c *= (knee + (1.0 - knee) * above * (1.0 + above / white_squared) / (1.0 + above)) / l;
  }
  c = clamp(clamp(c, 0.0, 1.0) * plate.a + plate.rgb, 0.0, 1.0);
  color = vec4(display == 0 ? srgb(c) : display == 1 ? rec709(c) : c, value.a);
}
