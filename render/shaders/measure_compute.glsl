// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Sums, per block of 64×64 pixels, what Reinhard's operator needs: Σ ln luminance, the number of lit pixels, the largest
// luminance. Black pixels have no logarithm and are left out.
layout(local_size_x = 16, local_size_y = 16) in;
uniform sampler2D radiance_map;
layout(std430, binding = 0) writeonly buffer Blocks { vec4 blocks[]; };
shared vec4 partial[256];

void main() {
  ivec2 size = textureSize(radiance_map, 0);
  vec4 mine = vec4(0.0);
  for (int k = 0; k < 16; ++k) {
    ivec2 at = ivec2(gl_WorkGroupID.xy) * 64 + ivec2(gl_LocalInvocationID.xy) + 16 * ivec2(k & 3, k >> 2);
    if (at.x >= size.x || at.y >= size.y) continue;
    float luminance = dot(texelFetch(radiance_map, at, 0).rgb, vec3(0.2126, 0.7152, 0.0722));
    if (!(luminance > 1e-37)) continue;  // drivers take smaller floats for 0
    mine = vec4(mine.x + log(luminance), mine.y + 1.0, max(mine.z, luminance), 0.0);
  }
  uint i = gl_LocalInvocationIndex;
  partial[i] = mine;
  barrier();
  for (uint half_size = 128u; half_size > 0u; half_size >>= 1) {
    if (i < half_size) {
      vec4 a = partial[i];
      vec4 b = partial[i + half_size];
      partial[i] = vec4(a.x + b.x, a.y + b.y, max(a.z, b.z), 0.0);
    }
    barrier();
  }
  if (i == 0u) blocks[gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x] = partial[0];
}
