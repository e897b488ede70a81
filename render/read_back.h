// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "render/gl_objects.h"

namespace lightwell::render {

// RGBA of a framebuffer's lower left corner, row 0 at the top. Value: float, or std::uint8_t.
template <class Value>
std::vector<Value> read_back(GLuint framebuffer, int width, int height) {
  static_assert(std::is_same_v<Value, float> || std::is_same_v<Value, std::uint8_t>);
  const std::size_t row = static_cast<std::size_t>(width) * 4;
  std::vector<Value> rgba(row * static_cast<std::size_t>(height));
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGBA, std::is_same_v<Value, float> ? GL_FLOAT : GL_UNSIGNED_BYTE,
               rgba.data());
  // OpenGL's first row is the lowest.
  for (std::size_t low = 0, high = static_cast<std::size_t>(height); low + 1 < high; ++low) {
    --high;
    std::swap_ranges(rgba.data() + low * row, rgba.data() + (low + 1) * row, rgba.data() + high * row);
  }
  return rgba;
}

}  // namespace lightwell::render
