// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/shadow_atlas.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace lightwell::render {

int ShadowAtlas::side_limit() {
  GLint driver = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &driver);
  return std::min(4096, static_cast<int>(driver));
}

Result<ShadowAtlas> ShadowAtlas::create(const Casters& casters, int map_size) {
  ShadowAtlas atlas;
  atlas.map_size_ = map_size;
  atlas.closed_count_ = static_cast<GLsizei>(casters.closed_count);
  atlas.open_count_ = static_cast<GLsizei>(casters.open_count);
  atlas.support_count_ = static_cast<GLsizei>(casters.support_count);
  auto program = gl::make_program("shadow_vertex", "empty_fragment");
  if (!program) return program.error();
  atlas.program_ = std::move(program).value();
  atlas.vertex_array_ = gl::make_vertex_array();
  glBindVertexArray(atlas.vertex_array_.id());
  atlas.positions_ =
      gl::make_buffer(GL_ARRAY_BUFFER, casters.positions.data(), casters.positions.size() * sizeof(Vec3f));
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(Vec3f), nullptr);
  atlas.indices_ = gl::make_buffer(GL_ELEMENT_ARRAY_BUFFER, casters.indices.data(),
                                   casters.indices.size() * sizeof(casters.indices[0]));
  for (const GLuint row : {1u, 2u, 3u}) {
    glEnableVertexAttribArray(row);
    glVertexAttribDivisor(row, 1);
  }
  glBindVertexArray(0);
  if (Status s = atlas.resize(1); !s) return s.error();
  return atlas;
}

void ShadowAtlas::move(const Casters& casters) {
  glBindBuffer(GL_ARRAY_BUFFER, positions_.id());
  for (const Casters::Part& part : casters.parts)
    if (part.moved && part.position_count > 0)
      glBufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(part.first_position * sizeof(Vec3f)),
                      static_cast<GLsizeiptr>(part.position_count * sizeof(Vec3f)),
                      &casters.positions[part.first_position]);
}

int ShadowAtlas::capacity() const {
  const int side = side_limit() / map_size_;
  return std::min(kMaxLightsPerBlock, side * side);
}

Status ShadowAtlas::resize(int tiles) {
  if (tiles == tiles_) return {};
  tiles_ = tiles;
  texture_ = gl::make_texture(GL_DEPTH_COMPONENT16, tiles * map_size_, tiles * map_size_);
  for (const GLenum filter : {GLenum{GL_TEXTURE_MIN_FILTER}, GLenum{GL_TEXTURE_MAG_FILTER}})
    glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  auto framebuffer = gl::make_framebuffer({}, texture_.id());
  if (!framebuffer) return framebuffer.error();
  framebuffer_ = std::move(framebuffer).value();
  return {};
}

void ShadowAtlas::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  glViewport(0, 0, tiles_ * map_size_, tiles_ * map_size_);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
}

Status ShadowAtlas::draw(std::span<const LightRow> rows, GLuint buffer) {
  const auto count = static_cast<GLsizei>(rows.size());
  const int tiles = std::max(1, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(count)))));
  if (Status s = resize(tiles); !s) return s;
  bind();
  glClear(GL_DEPTH_BUFFER_BIT);
  glUseProgram(program_.id());
  glUniform1i(gl::uniform(program_, "tiles"), tiles);
  const GLint supports = gl::uniform(program_, "supports");
  glUniform1i(supports, 0);
  glBindVertexArray(vertex_array_.id());
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  // Instances begin at this light.
  const auto begin_at = [](std::size_t light) {
    const std::size_t offsets[] = {offsetof(LightRow, u), offsetof(LightRow, v), offsetof(LightRow, w)};
    for (GLuint row = 0; row < 3; ++row)
      glVertexAttribPointer(row + 1, 4, GL_FLOAT, GL_FALSE, sizeof(LightRow),
                            reinterpret_cast<const void*>(light * sizeof(LightRow) + offsets[row]));
  };
  begin_at(0);
  const auto run = [&](GLsizei first_index, GLsizei indices, GLsizei instances) {
    if (indices == 0 || instances == 0) return;
    const auto offset = static_cast<std::uintptr_t>(first_index) * sizeof(std::uint32_t);
    glDrawElementsInstanced(GL_TRIANGLES, indices, GL_UNSIGNED_INT, reinterpret_cast<const void*>(offset),
                            instances);
  };
  // Of a closed mesh the side toward the light is the nearer one everywhere: the other half need not be
  // drawn.
  glEnable(GL_CULL_FACE);
  glCullFace(GL_BACK);
  run(0, closed_count_, count);
  glDisable(GL_CULL_FACE);
  run(closed_count_, open_count_, count);
  for (int i = 0; i < count && support_count_ > 0; ++i) {
    if (rows[static_cast<std::size_t>(i)].extent_m < 0) continue;
    glViewport(i % tiles * map_size_, i / tiles * map_size_, map_size_, map_size_);
    glUniform1i(supports, 1);
    begin_at(static_cast<std::size_t>(i));
    run(closed_count_ + open_count_, support_count_, 1);
  }
  return {};
}

}  // namespace lightwell::render
