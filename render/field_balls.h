// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "lighting/field/field_grid.h"
#include "render/camera.h"
#include "render/gl_objects.h"
#include "render/scene.h"

namespace lightwell::render {

// Balls that show the light at places of a field's grid. They cast no shadows.
struct FieldBallsOptions {
  int most = 0;         // along each axis, evenly from bound to bound; 0: one at every grid point
  bool mirror = false;  // smooth metal; else white and matt
};
Material field_ball_material(const FieldBallsOptions& options);

// Draws the balls into a G-buffer, all with one call: one mesh, whose places the vertex shader counts out.
class FieldBalls {
 public:
  // material: which of the scene's materials field_ball_material() is; emission: the G-buffer has that target.
  static Result<FieldBalls> create(const FieldBallsOptions& options, std::size_t material, bool emission);
  void set_grid(const FieldGrid& grid);
  // Into the G-buffer that is bound.
  void draw(const View& view) const;
  [[nodiscard]] std::size_t count() const;

 private:
  FieldBallsOptions options_;
  std::size_t material_ = 0;
  bool emission_ = false;
  std::array<int, 3> shown_ = {0, 0, 0};
  Vec3f first_ = Vec3f::Zero();
  Vec3f step_ = Vec3f::Zero();
  float radius_ = 0;
  gl::Program program_;
  gl::VertexArray vertex_array_;
  gl::Buffer positions_, indices_;
  GLsizei index_count_ = 0;
};

}  // namespace lightwell::render
