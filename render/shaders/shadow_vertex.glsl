// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// One instance a light, each into its own tile of the atlas. The objects fit their tiles: nothing needs clipping.
// ONE_VIEW: into one map of a lamp, whose tile is the viewport.
layout(location = 0) in vec3 position;
#ifdef ONE_VIEW
uniform mat4 clip_from_world;
#else
layout(location = 1) in vec4 u;  // of the instance's light, into the atlas's clip space
layout(location = 2) in vec4 v;
layout(location = 3) in vec4 w;
#endif
uniform int supports;  // only into the light's tile; nearer to the light than everything, inside the clip volume
#ifdef CUTOUT
layout(location = 4) in vec2 uv;
layout(location = 5) in vec4 color;
out vec2 texture_uv;
out float vertex_alpha;
#endif

void main() {
#ifdef CUTOUT
  texture_uv = uv;
  vertex_alpha = color.a;
#endif
  vec4 p = vec4(position, 1.0);
#ifdef ONE_VIEW
  gl_Position = clip_from_world * p;
  if (supports != 0) gl_Position.z = -0.9999 * gl_Position.w;
#else
  gl_Position = vec4(dot(u, p), dot(v, p), supports != 0 ? -0.9999 : dot(w, p), 1.0);
#endif
}
