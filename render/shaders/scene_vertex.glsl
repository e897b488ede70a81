// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
uniform mat4 clip_from_world;
out vec3 world_position;
out vec3 world_normal;
out vec2 texture_uv;

void main() {
  world_position = position;
  world_normal = normal;
  texture_uv = uv;
  gl_Position = clip_from_world * vec4(position, 1.0);
}
