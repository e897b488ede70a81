// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "render/gl_objects.h"
#include "render/look.h"
#include "render/picture.h"

namespace lightwell::render {

// A plate whose values are a display's light, and its part of a picture.
struct GradedPlate {
  GLuint share = 0;  // texture: the plate's values where and as far as it is seen; alpha: what objects cover
  float white = 1;   // radiance that the picture has for the plate's 1
};

// Linear radiance to 8 bit codes of a display. Reinhard's global operator (Reinhard et al. 2002, eqs. 1, 2 and 4) with
// its two parameters, the log-average luminance and the white point, followed over time (Adaptation) or set by an
// exposure: then the log-average luminance is the metered one, and white lies kWhiteStops above it. Without an operator
// the saturating luminance is white, or radiance 1. False colours show luminance as it is measured.
// Before a plate that was graded for a display, only the objects are mapped: without an exposure the radiance of the
// plate's 1 is white, and Reinhard's operator, which would change the plate's look beside them, bends only what lies
// above kKnee, so that an object as bright as a part of the plate has its codes.
class ToneMapper {
 public:
  static constexpr double kWhiteStops = 5;
  static constexpr double kKnee = 0.8;  // of white: sRGB code 231; the codes above are for what is brighter

  static Result<ToneMapper> create();
  Status resize(int width, int height);
  void set_look(const Look& look);

  // Measures radiance and moves the parameters; the first frame sets them. dt_s: time since the frame before.
  void adapt(GLuint radiance, double dt_s);
  // Draws into the 8 bit picture, or into the window's framebuffer.
  void draw(GLuint radiance);
  void draw_to_window(GLuint radiance) const;
  // What the next pictures stand before; nothing: no plate, or one that is radiance as the objects are.
  void set_plate(const std::optional<GradedPlate>& plate) { plate_ = plate; }
  [[nodiscard]] DisplayPicture read() const;
  [[nodiscard]] const Look& look() const { return look_; }
  // By hand, or what the picture asked for.
  [[nodiscard]] double exposure_ev100() const;

 private:
  struct Parameters {
    double scale = 1;         // of radiance, before the operator
    double knee = 0;          // scaled luminance below which the operator changes nothing
    double white = 1;         // scaled luminance that becomes white
    double middle_cd_m2 = 1;  // luminance of middle grey
  };
  [[nodiscard]] Parameters parameters() const;
  void make_false_colours();
  void draw_into(GLuint framebuffer, GLuint radiance, bool straight_alpha) const;

  int width_ = 0;
  int height_ = 0;
  Look look_;
  Adaptation adaptation_;
  std::optional<GradedPlate> plate_;
  gl::Program measure_;
  gl::Program program_;
  gl::VertexArray no_vertices_;
  gl::Buffer blocks_;
  gl::Texture picture_;
  gl::Framebuffer framebuffer_;
  gl::Texture colours_;  // of false colour, one row
  gl::Texture legend_;
  int legend_width_ = 0;
  int legend_height_ = 0;
};

}  // namespace lightwell::render
