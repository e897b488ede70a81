// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/tone_mapper.h"

#include <algorithm>
#include <cmath>

#include "render/false_colour.h"
#include "render/read_back.h"

namespace lightwell::render {
namespace {

constexpr int kBlock = 64;      // pixels a side that one work group measures (measure_compute.glsl)
constexpr int kColours = 1024;  // more than an eye tells apart on the scale

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
  t.colours_ = gl::make_texture(GL_RGBA8, 1, 1);
  t.legend_ = gl::make_texture(GL_RGBA8, 1, 1);
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
  make_false_colours();
  return {};
}

void ToneMapper::set_look(const Look& look) {
  look_ = look;
  make_false_colours();
}

void ToneMapper::make_false_colours() {
  legend_width_ = legend_height_ = 0;
  if (look_.false_colour == FalseColour::none) return;
  const FalseColourScale scale{look_.false_colour};
  std::vector<std::uint8_t> row;
  for (const Rgb8& colour : scale.table(kColours))
    row.insert(row.end(), {colour[0], colour[1], colour[2], std::uint8_t{255}});
  colours_ = gl::make_texture(GL_RGBA8, kColours, 1);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, kColours, 1, GL_RGBA, GL_UNSIGNED_BYTE, row.data());
  const Legend legend = make_legend(scale, height_);
  if (legend.width == 0 || legend.width > width_ / 2) return;
  legend_width_ = legend.width;
  legend_height_ = legend.height;
  legend_ = gl::make_texture(GL_RGBA8, legend.width, legend.height);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, legend.width, legend.height, GL_RGBA, GL_UNSIGNED_BYTE,
                  legend.rgba.data());
}

void ToneMapper::adapt(GLuint radiance, double dt_s) {
  const bool needed = look_.operation == ToneMap::reinhard || look_.false_colour == FalseColour::stops;
  if (!needed || look_.exposure_ev100) return;
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
  adaptation_.follow(log_sum / lit, std::log(largest), dt_s);
}

ToneMapper::Parameters ToneMapper::parameters() const {
  Parameters p;
  const auto& ev100 = look_.exposure_ev100;
  if (ev100) {
    p.middle_cd_m2 = metered_luminance_cd_m2(*ev100);
    p.scale = look_.operation == ToneMap::none ? 1 / saturating_luminance_cd_m2(*ev100)
                                               : kMiddleGrey / p.middle_cd_m2;
    p.white = kMiddleGrey * std::exp2(kWhiteStops);
  } else if (plate_) {
    p.scale = 1 / static_cast<double>(plate_->white);
    p.middle_cd_m2 = kMiddleGrey / p.scale;
    if (adaptation_.adapted()) p.white = p.scale * adaptation_.white_cd_m2();
  } else if (adaptation_.adapted()) {
    p.middle_cd_m2 = adaptation_.average_cd_m2();
    if (look_.operation == ToneMap::none) return p;
    p.scale = kMiddleGrey / p.middle_cd_m2;
    p.white = p.scale * adaptation_.white_cd_m2();
  }
  if (plate_) {
    p.knee = kKnee;
    p.white = std::max(p.white, 1.0);  // the operator must not brighten
  }
  return p;
}

double ToneMapper::exposure_ev100() const {
  return std::log2(parameters().middle_cd_m2 / metered_luminance_cd_m2(0));
}

void ToneMapper::draw(GLuint radiance) {
  draw_into(framebuffer_.id(), radiance, true);
}
void ToneMapper::draw_to_window(GLuint radiance) const {
  draw_into(0, radiance, false);
}

void ToneMapper::draw_into(GLuint framebuffer, GLuint radiance, bool straight_alpha) const {
  const Parameters p = parameters();
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, width_, height_);
  glDisable(GL_DEPTH_TEST);
  glUseProgram(program_.id());
  glUniform1i(gl::uniform(program_, "radiance_map"), 0);
  const auto set = [&](const char* name, int value) { glUniform1i(gl::uniform(program_, name), value); };
  const auto set_float = [&](const char* name, double value) {
    glUniform1f(gl::uniform(program_, name), static_cast<float>(value));
  };
  set("reinhard", look_.operation == ToneMap::reinhard ? 1 : 0);
  set_float("scale", p.scale);
  set_float("knee", p.knee);
  set_float("white_squared", std::max(std::pow((p.white - p.knee) / (1 - p.knee), 2), 1e-12));
  set("over_plate", plate_ ? 1 : 0);
  set("plate_share", 3);
  set_float("plate_white", plate_ ? static_cast<double>(plate_->white) : 1.0);
  set("straight_alpha", straight_alpha ? 1 : 0);
  set("display", static_cast<int>(look_.display));
  set("false_colour", look_.false_colour != FalseColour::none ? 1 : 0);
  if (look_.false_colour != FalseColour::none) {
    const FalseColourScale scale{look_.false_colour};
    const double zero = look_.false_colour == FalseColour::stops ? std::log2(p.middle_cd_m2) : 0;
    set_float("scale_low", scale.low() + zero);
    set_float("scale_high", scale.high() + zero);
  }
  set("colours", 1);
  set("legend", 2);
  glUniform2i(gl::uniform(program_, "legend_size"), legend_width_, legend_height_);
  set("picture_height", height_);
  gl::bind_texture(1, colours_.id());
  gl::bind_texture(2, legend_.id());
  gl::bind_texture(3, plate_ ? plate_->share : 0);
  gl::bind_texture(0, radiance);
  glBindVertexArray(no_vertices_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

DisplayPicture ToneMapper::read() const {
  return {width_, height_, read_back<std::uint8_t>(framebuffer_.id(), width_, height_),
          look_.false_colour != FalseColour::none ? Display::srgb : look_.display};
}

}  // namespace lightwell::render
