// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Before shade_fragment.glsl: the lights that a normal can see, by the cell of a cube map that it lies in (light_lists.h).
uniform highp usampler2D light_lists;

int cell_of(vec3 normal) {
  vec3 a = abs(normal);
  bool x = a.x >= max(a.y, a.z), y = a.y >= a.z;
  vec3 n = x ? normal.yzx : y ? normal.zxy : normal;  // across the face, up, along its axis
  int face = (x ? 0 : y ? 2 : 4) + (n.z < 0.0 ? 1 : 0);
  ivec2 at = min(ivec2((n.xy / abs(n.z) * 0.5 + 0.5) * float(LIST_SIDE)), LIST_SIDE - 1);
  return (face * LIST_SIDE + at.y) * LIST_SIDE + at.x;
}

int list_entry(int column, int cell) { return int(texelFetch(light_lists, ivec2(column, cell), 0).x); }
