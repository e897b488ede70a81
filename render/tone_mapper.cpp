// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/tone_mapper.h"

#include <algorithm>
#include <cmath>

namespace lightwell::render {
namespace {

constexpr int kBlock = 64;       // pixels a side that one work group measures (measure_compute.glsl)
constexpr double kKey = 0.18;    // middle grey (Reinhard et al. 2002, eq. 2)
constexpr double kAdaptS = 0.4;  // time constant: fast enough to follow a walk, too slow to follow flicker

int blocks(int pixels) {
  return (pixels + kBlock - 1) / kBlock;
}

}  // namespace

Result<ToneMapper> ToneMapper::create() {
  ToneMapper t;
  auto measure = gl::make_compute_program("measure_compute");
  if (!measure) return measure.error();
  auto program = gl::make_program("fullscreen_vertex", "tonemap_fragment");
  if (!program) return program.error();
  t.measure_ = std::move(measure).value();
  t.program_ = std::move(program).value();
  t.no_vertices_ = gl::make_vertex_array();
  return t;
}

Status ToneMapper::resize(int width, int height) {
  if (width == width_ && height == height_) return {};
  width_ = width;
  height_ = height;
  const auto bytes = static_cast<std::size_t>(blocks(width) * blocks(height)) * 4 * sizeof(float);
  blocks_ = gl::make_buffer(GL_SHADER_STORAGE_BUFFER, nullptr, bytes, GL_DYNAMIC_READ);
  picture_ = gl::make_texture(GL_RGBA8, width, height);
  auto framebuffer = gl::make_framebuffer({picture_.id()}, 0);
  if (!framebuffer) return framebuffer.error();
  framebuffer_ = std::move(framebuffer).value();
  return {};
}

void ToneMapper::adapt(GLuint radiance, ToneMap operation, double dt_s) {
  operation_ = operation;
  if (operation == ToneMap::none) return;
  glUseProgram(measure_.id());
  glUniform1i(gl::uniform(measure_, "radiance_map"), 0);
  gl::bind_texture(0, radiance);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, blocks_.id());
  glDispatchCompute(static_cast<GLuint>(blocks(width_)), static_cast<GLuint>(blocks(height_)), 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  const auto count = static_cast<std::size_t>(blocks(width_) * blocks(height_));
  const auto* block = static_cast<const float*>(glMapBufferRange(
      GL_SHADER_STORAGE_BUFFER, 0, static_cast<GLsizeiptr>(count * 4 * sizeof(float)), GL_MAP_READ_BIT));
  if (block == nullptr) return;
  double log_sum = 0;
  double lit = 0;
  double largest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    log_sum += block[4 * i];
    lit += block[4 * i + 1];
    largest = std::max(largest, static_cast<double>(block[4 * i + 2]));
  }
  glUnmapBuffer(GL_SHADER_STORAGE_BUFFER);
  if (!(lit > 0) || !std::isfinite(log_sum) || !std::isfinite(largest)) return;  // all black: keep what was
  const double blend = adapted_ ? 1 - std::exp(-std::max(dt_s, 0.0) / kAdaptS) : 1;
  log_average_ += blend * (log_sum / lit - log_average_);
  log_white_ += blend * (std::log(largest) - log_white_);
  adapted_ = true;
}

void ToneMapper::draw(GLuint radiance) {
  draw_into(framebuffer_.id(), radiance, true);
}
void ToneMapper::draw_to_window(GLuint radiance) const {
  draw_into(0, radiance, false);
}

void ToneMapper::draw_into(GLuint framebuffer, GLuint radiance, bool straight_alpha) const {
  const double scale = adapted_ ? kKey / std::exp(log_average_) : 1;
  const double white = adapted_ ? scale * std::exp(log_white_) : 1;
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, width_, height_);
  glDisable(GL_DEPTH_TEST);
  glUseProgram(program_.id());
  glUniform1i(gl::uniform(program_, "radiance_map"), 0);
  glUniform1i(gl::uniform(program_, "reinhard"), operation_ == ToneMap::reinhard ? 1 : 0);
  glUniform1f(gl::uniform(program_, "scale"), static_cast<float>(scale));
  glUniform1f(gl::uniform(program_, "white_squared"), static_cast<float>(std::max(white * white, 1e-12)));
  glUniform1i(gl::uniform(program_, "straight_alpha"), straight_alpha ? 1 : 0);
  gl::bind_texture(0, radiance);
  glBindVertexArray(no_vertices_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

DisplayPicture ToneMapper::read() const {
  DisplayPicture picture{width_, height_,
                         std::vector<std::uint8_t>(static_cast<std::size_t>(width_ * height_) * 4)};
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, picture.rgba.data());
  const auto row = static_cast<std::ptrdiff_t>(width_) * 4;
  for (std::ptrdiff_t y = 0; y < height_ / 2; ++y)
    std::swap_ranges(picture.rgba.begin() + y * row, picture.rgba.begin() + (y + 1) * row,
                     picture.rgba.begin() + (height_ - 1 - y) * row);
  return picture;
}

}  // namespace lightwell::render
