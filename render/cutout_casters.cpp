// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/cutout_casters.h"

#include <cstddef>

namespace lightwell::render {

Result<CutoutCasters> CutoutCasters::create(const Scene& scene, const Casters& casters,
                                            const GBuffer& gbuffer) {
  CutoutCasters c;
  for (const std::size_t i : casters.cutouts) {
    const Material& m = scene.materials[static_cast<std::size_t>(scene.primitives[i].material)];
    c.draws_.push_back(
        {scene.primitives[i], m.base_color_texture, gbuffer.base_color(i), m.alpha, m.alpha_cutoff});
  }
  if (c.draws_.empty()) return c;
  auto program = gl::make_program("shadow_vertex", "cutout_fragment", "#define CUTOUT\n");
  if (!program) return program.error();
  c.program_ = std::move(program).value();
  auto one_view = gl::make_program("shadow_vertex", "cutout_fragment", "#define CUTOUT\n#define ONE_VIEW\n");
  if (!one_view) return one_view.error();
  c.one_view_ = std::move(one_view).value();
  for (gl::VertexArray* array : {&c.alone_, &c.vertex_array_}) {
    *array = gl::make_vertex_array();
    glBindVertexArray(array->id());
    glBindBuffer(GL_ARRAY_BUFFER, gbuffer.vertices());
    const auto attribute = [](GLuint index, GLint components, GLenum type, std::size_t offset) {
      glEnableVertexAttribArray(index);
      glVertexAttribPointer(index, components, type, GL_TRUE, sizeof(Vertex),
                            reinterpret_cast<const void*>(offset));
    };
    attribute(0, 3, GL_FLOAT, offsetof(Vertex, position));
    attribute(4, 2, GL_FLOAT, offsetof(Vertex, uv));
    attribute(5, 4, GL_UNSIGNED_SHORT, offsetof(Vertex, color));
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, gbuffer.indices());
  }
  for (const GLuint row : {1u, 2u, 3u}) {
    glEnableVertexAttribArray(row);
    glVertexAttribDivisor(row, 1);
  }
  glBindVertexArray(0);
  return c;
}

void CutoutCasters::draw(const ShadowAtlas& atlas) const {
  if (draws_.empty() || atlas.drawn() == 0) return;
  glUseProgram(program_.id());
  glUniform1i(gl::uniform(program_, "supports"), 0);
  glUniform1i(gl::uniform(program_, "base_color_map"), 0);
  glBindVertexArray(vertex_array_.id());
  glBindBuffer(GL_ARRAY_BUFFER, atlas.instances());
  glDisable(GL_CULL_FACE);
  for (const ShadowAtlas::Block& maps : atlas.drawn_on()) {
    atlas.bind(maps.page);
    const std::size_t offsets[] = {offsetof(MapRows, u), offsetof(MapRows, v), offsetof(MapRows, w)};
    for (GLuint row = 0; row < 3; ++row)
      glVertexAttribPointer(row + 1, 4, GL_FLOAT, GL_FALSE, sizeof(MapRows),
                            reinterpret_cast<const void*>(maps.first * sizeof(MapRows) + offsets[row]));
    draw_all(program_, static_cast<GLsizei>(maps.count));
  }
}

void CutoutCasters::draw(const Mat4f& clip_from_world) const {
  if (draws_.empty()) return;
  glUseProgram(one_view_.id());
  glUniformMatrix4fv(gl::uniform(one_view_, "clip_from_world"), 1, GL_FALSE, clip_from_world.data());
  glUniform1i(gl::uniform(one_view_, "base_color_map"), 0);
  glBindVertexArray(alone_.id());
  glDisable(GL_CULL_FACE);
  draw_all(one_view_, 1);
}

// program: in use
void CutoutCasters::draw_all(const gl::Program& program, GLsizei instances) const {
  for (const Draw& draw : draws_) {
    gl::bind_texture(0, draw.texture);
    glUniform3fv(gl::uniform(program, "base_color_uv"), 2, draw.use.from_uv.data());
    glUniform1f(gl::uniform(program, "alpha"), draw.alpha);
    glUniform1f(gl::uniform(program, "alpha_cutoff"), draw.alpha_cutoff);
    const auto offset = static_cast<std::uintptr_t>(draw.primitive.first_index) * sizeof(std::uint32_t);
    glDrawElementsInstanced(GL_TRIANGLES, static_cast<GLsizei>(draw.primitive.index_count), GL_UNSIGNED_INT,
                            reinterpret_cast<const void*>(offset), instances);
  }
}

}  // namespace lightwell::render
