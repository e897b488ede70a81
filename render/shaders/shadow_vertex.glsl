// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// One instance a light, each into its own tile of the atlas. The objects fit their tiles: nothing needs clipping.
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 u;  // of the instance's light
layout(location = 2) in vec4 v;
layout(location = 3) in vec4 w;
#ifdef CUTOUT
layout(location = 4) in vec2 uv;
layout(location = 5) in vec4 color;
out vec2 texture_uv;
out float vertex_alpha;
#endif
uniform int tiles;
uniform int supports;  // alone, into a viewport that is the light's tile and clips them

void main() {
#ifdef CUTOUT
  texture_uv = uv;
  vertex_alpha = color.a;
#endif
  vec4 p = vec4(position, 1.0);
  vec3 place = vec3(dot(u, p), dot(v, p), dot(w, p));
  if (supports != 0) {
    // Nearer to the light than everything, inside the clip volume.
    gl_Position = vec4(place.xy * 2.0 - 1.0, -0.9999, 1.0);
    return;
  }
  // In floats: integer division is slow on many machines. Half a light keeps the quotient off whole numbers.
  float row = floor((float(gl_InstanceID) + 0.5) / float(tiles));
  vec2 tile = vec2(float(gl_InstanceID) - row * float(tiles), row);
  gl_Position = vec4((tile + place.xy) * (2.0 / float(tiles)) - 1.0, place.z * 2.0 - 1.0, 1.0);
}
