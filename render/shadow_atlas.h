// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "render/casters.h"
#include "render/gl_objects.h"
#include "render/light_rows.h"

namespace lightwell::render {

// Shadow maps of many lights as tiles of one 16 bit depth texture.
class ShadowAtlas {
 public:
  // map_size: texels a side of one map, at most side_limit().
  static Result<ShadowAtlas> create(const Casters& casters, int map_size);

  // Largest side of an atlas on this driver: 4096, which small boards have, or what the driver allows.
  static int side_limit();
  // Lights whose maps the atlas holds at once.
  [[nodiscard]] int capacity() const;
  [[nodiscard]] int map_size() const { return map_size_; }
  [[nodiscard]] int tiles() const { return tiles_; }  // a side
  [[nodiscard]] GLuint texture() const { return texture_.id(); }
  [[nodiscard]] bool empty() const { return closed_count_ + open_count_ + support_count_ == 0; }

  // Follows the parts that moved of the casters that it was made of.
  void move(const Casters& casters);
  // Makes the whole atlas the place to draw to.
  void bind() const;
  // Draws the maps of rows, at most capacity(), which are the first of buffer.
  Status draw(std::span<const LightRow> rows, GLuint buffer);

 private:
  Status resize(int tiles);

  int map_size_ = 256;
  int tiles_ = 0;
  GLsizei closed_count_ = 0;
  GLsizei open_count_ = 0;
  GLsizei support_count_ = 0;
  gl::Program program_;
  gl::VertexArray vertex_array_;
  gl::Buffer positions_;
  gl::Buffer indices_;
  gl::Texture texture_;
  gl::Framebuffer framebuffer_;
};

}  // namespace lightwell::render
