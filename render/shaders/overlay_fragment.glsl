// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
in vec2 font_uv;
in vec4 font_tint;
uniform sampler2D font;
out vec4 color;

void main() {
  color = vec4(font_tint.rgb, font_tint.a * texture(font, font_uv).r);
}
