// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Puts a picture over a part of another: its opaque pixels.
in vec2 ndc;
uniform sampler2D over_map;  // row 0 at the top
uniform ivec2 corner;        // lower left, of the viewport
layout(location = 0) out vec4 radiance;
layout(location = 1) out vec4 plate_share;  // where a plate lies behind: none of it

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy) - corner;
  radiance = texelFetch(over_map, ivec2(at.x, textureSize(over_map, 0).y - 1 - at.y), 0);
  plate_share = vec4(0.0, 0.0, 0.0, 1.0);
  if (radiance.a < 1.0) discard;
}
