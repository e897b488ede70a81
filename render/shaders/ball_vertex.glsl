// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Balls on a lattice, one an instance, x running fastest (field_balls.h).
layout(location = 0) in vec3 position;  // of the unit sphere, and its normal
uniform mat4 clip_from_world;
uniform vec3 first, step_m;
uniform ivec3 shown;
uniform float radius;
out vec3 world_position;
out vec3 world_normal;

void main() {
  ivec3 at = ivec3(gl_InstanceID % shown.x, gl_InstanceID / shown.x % shown.y, gl_InstanceID / (shown.x * shown.y));
  world_normal = position;
  world_position = first + vec3(at) * step_m + radius * position;
  gl_Position = clip_from_world * vec4(world_position, 1.0);
}
