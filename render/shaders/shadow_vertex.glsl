// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// One instance a light, each into its own tile of the atlas. The objects fit their tiles: nothing needs clipping.
layout(location = 0) in vec3 position;
struct Light { vec4 u, v, w, illuminance; };
layout(std140) uniform Lights { Light lights[256]; };
uniform int tiles;
uniform int support_light;  // its supports alone, into a viewport that is its tile and clips them; −1: all lights

void main() {
  int i = support_light < 0 ? gl_InstanceID : support_light;
  vec4 p = vec4(position, 1.0);
  vec3 place = vec3(dot(lights[i].u, p), dot(lights[i].v, p), dot(lights[i].w, p));
  if (support_light >= 0) {
    // Nearer to the light than everything, inside the clip volume.
    gl_Position = vec4(place.xy * 2.0 - 1.0, -0.9999, 1.0);
    return;
  }
  // In floats: integer division is slow on many machines. Half a light keeps the quotient off whole numbers.
  float row = floor((float(i) + 0.5) / float(tiles));
  vec2 tile = vec2(float(i) - row * float(tiles), row);
  gl_Position = vec4((tile + place.xy) * (2.0 / float(tiles)) - 1.0, place.z * 2.0 - 1.0, 1.0);
}
