// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/compositor.h"

#include <algorithm>

namespace lightwell::render {

Result<Compositor> Compositor::create() {
  Compositor c;
  auto program = gl::make_program("fullscreen_vertex", "composite_fragment");
  if (!program) return program.error();
  c.program_ = std::move(program).value();
  c.no_vertices_ = gl::make_vertex_array();
  c.plate_ = gl::make_texture(GL_RGBA32F, 1, 1);
  return c;
}

void Compositor::set_plate(const Plate& plate, float white) {
  white_ = white;
  graded_ = plate.display_referred;
  GLint limit = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
  const int step = 1 + (std::max(plate.width, plate.height) - 1) / limit;
  const int width = (plate.width + step - 1) / step;
  const int height = (plate.height + step - 1) / step;
  std::vector<float> rgba;
  rgba.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Rgb& c = plate.pixels[static_cast<std::size_t>(y * step) * static_cast<std::size_t>(plate.width) +
                                  static_cast<std::size_t>(x * step)];
      rgba.insert(rgba.end(), {c[0], c[1], c[2], 1.0f});
    }
  plate_ = gl::make_texture(GL_RGBA32F, width, height);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, GL_RGBA, GL_FLOAT, rgba.data());
}

Status Compositor::resize(int width, int height) {
  if (width == width_ && height == height_) return {};
  width_ = width;
  height_ = height;
  for (Sum& sum : sums_) {
    sum.texture = gl::make_texture(GL_RGBA32F, width, height);
    sum.plate_share = gl::make_texture(GL_RGBA32F, width, height);
    auto framebuffer = gl::make_framebuffer({sum.texture.id(), sum.plate_share.id()}, 0);
    if (!framebuffer) return framebuffer.error();
    sum.framebuffer = std::move(framebuffer).value();
  }
  return {};
}

void Compositor::add(GLuint shadowed, GLuint unshadowed, GLuint surface, float weight, bool start_sum) {
  const GLuint so_far = picture();
  const GLuint share_so_far = sums_[current_].plate_share.id();
  current_ = 1 - current_;
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer());
  glViewport(0, 0, width_, height_);
  glDisable(GL_DEPTH_TEST);
  glUseProgram(program_.id());
  const auto texture = [&](const char* name, int unit, GLuint id) {
    gl::bind_texture(unit, id);
    glUniform1i(gl::uniform(program_, name), unit);
  };
  texture("so_far", 0, so_far);
  texture("shadowed_map", 1, shadowed);
  texture("unshadowed_map", 2, unshadowed);
  texture("surface_map", 3, surface);
  texture("plate_map", 4, plate_.id());
  texture("share_so_far", 5, share_so_far);
  glUniform1f(gl::uniform(program_, "white"), white_);
  glUniform1f(gl::uniform(program_, "weight"), weight);
  glUniform1i(gl::uniform(program_, "start_sum"), start_sum ? 1 : 0);
  glBindVertexArray(no_vertices_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace lightwell::render
