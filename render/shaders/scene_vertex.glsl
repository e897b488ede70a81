// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 3) in vec4 color;
uniform mat4 clip_from_world;
out vec3 world_position;
out vec3 world_normal;
#if HAS_DETAIL
out vec2 texture_uv;
out vec4 vertex_color;
#endif

void main() {
  world_position = position;
  world_normal = normal;
#if HAS_DETAIL
  texture_uv = uv;
  vertex_color = color;
#endif
  gl_Position = clip_from_world * vec4(position, 1.0);
}
