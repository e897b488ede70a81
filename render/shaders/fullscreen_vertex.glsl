// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// One triangle over the whole picture, as far as can be: depth tells pixels with a surface from those without.
out vec2 ndc;

void main() {
  ndc = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0;
  gl_Position = vec4(ndc, 1.0, 1.0);
}
