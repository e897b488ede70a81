// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "render/casters.h"
#include "render/gl_objects.h"

namespace lightwell::render {

// Casters as a driver holds them, drawn instance by instance.
class CasterBuffers {
 public:
  explicit CasterBuffers(const Casters& casters);
  CasterBuffers() = default;

  [[nodiscard]] bool empty() const { return counts_[0] + counts_[1] + counts_[2] == 0; }
  [[nodiscard]] bool has_supports() const { return counts_[2] > 0; }
  // Positions of the parts that moved.
  void move(const Casters& casters);
  // Instances read three vec4 (locations 1 to 3) from this buffer, from byte `first` on.
  void bind(GLuint instances, std::size_t first) const;
  // For one instance that reads nothing.
  void bind_alone() const;
  // cull: of closed meshes only what faces the light, which is enough for lights outside of them
  void draw_objects(GLsizei instances, bool cull = true) const;
  void draw_supports() const;  // one instance

 private:
  void run(int which, GLsizei instances) const;

  GLsizei counts_[3] = {0, 0, 0};  // indices: closed, open, supports
  gl::VertexArray vertex_array_;
  gl::VertexArray alone_;
  gl::Buffer positions_;
  gl::Buffer indices_;
};

}  // namespace lightwell::render
