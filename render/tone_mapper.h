// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "render/gl_objects.h"
#include "render/picture.h"

namespace lightwell::render {

enum class ToneMap { none, reinhard };

// Linear radiance to 8 bit sRGB. Reinhard's global operator (Reinhard et al. 2002, eqs. 1, 2 and 4) with its
// two parameters, the log-average luminance and the white point, smoothed over time (Havran et al. 2005,
// section 4.4).
class ToneMapper {
 public:
  static Result<ToneMapper> create();
  Status resize(int width, int height);

  // Measures radiance and moves the parameters; the first frame sets them. dt_s: time since the frame before.
  void adapt(GLuint radiance, ToneMap operation, double dt_s);
  // Draws into the 8 bit picture, or into the window's framebuffer.
  void draw(GLuint radiance);
  void draw_to_window(GLuint radiance) const;
  [[nodiscard]] DisplayPicture read() const;

 private:
  void draw_into(GLuint framebuffer, GLuint radiance, bool straight_alpha) const;

  int width_ = 0;
  int height_ = 0;
  ToneMap operation_ = ToneMap::reinhard;
  bool adapted_ = false;
  double log_average_ = 0;
  double log_white_ = 0;
  gl::Program measure_;
  gl::Program program_;
  gl::VertexArray no_vertices_;
  gl::Buffer blocks_;
  gl::Texture picture_;
  gl::Framebuffer framebuffer_;
};

}  // namespace lightwell::render
