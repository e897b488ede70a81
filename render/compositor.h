// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "render/gl_objects.h"
#include "render/plate.h"
#include "render/tone_mapper.h"

namespace lightwell::render {

// Lays rendered objects over a plate. Objects cover it; what only receives shadows stands for the real surface that
// the plate shows there, so the plate stays, times the ratio of the light that the surface returns with the objects to
// that without them (a multiplicative form of Debevec 1998, section 6: its albedo cancels). Where no light falls, the
// ratio is 1. Works in the context that is current when it is created.
class Compositor {
 public:
  static Result<Compositor> create();
  // white: radiance of the plate's 1. Stretched over the whole picture. Plates larger than the driver's textures lose
  // rows and columns evenly.
  void set_plate(const Plate& plate, float white);
  Status resize(int width, int height);
  // Adds a sample of the pixels to the picture. shadowed, unshadowed: radiance with and without shadows, alpha the
  // surfaces' coverage; surface: the G-buffer's, which tells objects from receivers.
  void add(GLuint shadowed, GLuint unshadowed, GLuint surface, float weight, bool start_sum);
  // Alpha 1 everywhere.
  [[nodiscard]] GLuint picture() const { return sums_[current_].texture.id(); }
  // Both; the picture is the first.
  [[nodiscard]] GLuint framebuffer() const { return sums_[current_].framebuffer.id(); }
  // The plate where it is graded, for the display.
  [[nodiscard]] std::optional<GradedPlate> graded_plate() const {
    if (!graded_) return std::nullopt;
    return GradedPlate{sums_[current_].plate_share.id(), white_};
  }

 private:
  struct Sum {
    gl::Texture texture;
    gl::Texture plate_share;
    gl::Framebuffer framebuffer;
  };
  int width_ = 0;
  int height_ = 0;
  float white_ = 1;
  bool graded_ = false;
  gl::Program program_;
  gl::VertexArray no_vertices_;
  gl::Texture plate_;
  Sum sums_[2];  // read one, write the other: float blending is not guaranteed
  int current_ = 0;
};

}  // namespace lightwell::render
