// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/caster_buffers.h"

#include <cstdint>

namespace lightwell::render {

CasterBuffers::CasterBuffers(const Casters& casters)
    : counts_{static_cast<GLsizei>(casters.closed_count), static_cast<GLsizei>(casters.open_count),
              static_cast<GLsizei>(casters.support_count)},
      vertex_array_(gl::make_vertex_array()),
      alone_(gl::make_vertex_array()) {
  glBindVertexArray(vertex_array_.id());
  positions_ =
      gl::make_buffer(GL_ARRAY_BUFFER, casters.positions.data(), casters.positions.size() * sizeof(Vec3f));
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(Vec3f), nullptr);
  indices_ = gl::make_buffer(GL_ELEMENT_ARRAY_BUFFER, casters.indices.data(),
                             casters.indices.size() * sizeof(casters.indices[0]));
  for (const GLuint row : {1u, 2u, 3u}) {
    glEnableVertexAttribArray(row);
    glVertexAttribDivisor(row, 1);
  }
  glBindVertexArray(alone_.id());
  glBindBuffer(GL_ARRAY_BUFFER, positions_.id());
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(Vec3f), nullptr);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
  glBindVertexArray(0);
}

void CasterBuffers::move(const Casters& casters) {
  glBindBuffer(GL_ARRAY_BUFFER, positions_.id());
  for (const Casters::Part& part : casters.parts)
    if (part.moved && part.position_count > 0)
      glBufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(part.first_position * sizeof(Vec3f)),
                      static_cast<GLsizeiptr>(part.position_count * sizeof(Vec3f)),
                      &casters.positions[part.first_position]);
}

void CasterBuffers::bind(GLuint instances, std::size_t first) const {
  glBindVertexArray(vertex_array_.id());
  glBindBuffer(GL_ARRAY_BUFFER, instances);
  constexpr std::size_t kRow = 4 * sizeof(float);
  for (GLuint row = 0; row < 3; ++row)
    glVertexAttribPointer(row + 1, 4, GL_FLOAT, GL_FALSE, 3 * kRow,
                          reinterpret_cast<const void*>(first + row * kRow));
}

void CasterBuffers::bind_alone() const {
  glBindVertexArray(alone_.id());
}

void CasterBuffers::run(int which, GLsizei instances) const {
  if (counts_[which] == 0 || instances == 0) return;
  std::uintptr_t first = 0;
  for (int i = 0; i < which; ++i) first += static_cast<std::uintptr_t>(counts_[i]);
  glDrawElementsInstanced(GL_TRIANGLES, counts_[which], GL_UNSIGNED_INT,
                          reinterpret_cast<const void*>(first * sizeof(std::uint32_t)), instances);
}

void CasterBuffers::draw_objects(GLsizei instances, bool cull) const {
  // Of a closed mesh the side toward the light is the nearer one everywhere: the other half need not be drawn.
  if (cull) glEnable(GL_CULL_FACE);
  glCullFace(GL_BACK);
  run(0, instances);
  glDisable(GL_CULL_FACE);
  run(1, instances);
}

void CasterBuffers::draw_supports() const {
  // Only those that turn their back to the light are in its way.
  glEnable(GL_CULL_FACE);
  glCullFace(GL_FRONT);
  run(2, 1);
  glDisable(GL_CULL_FACE);
}

}  // namespace lightwell::render
