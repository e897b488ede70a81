// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lighting/field/main_lights.h"
#include "render/field_layout.h"
#include "render/gl_objects.h"

namespace lightwell::render {

// A light field in 3D textures of half floats, trilinear.
class FieldTextures {
 public:
  // As FieldLayout::create(); the textures are made when they are first filled.
  void set_layout(const FieldLayout& layout);
  // The layout's grid and degree, and as many lights.
  void fill(const LightField& field, const MainLights& lights);
  void bind(int first_unit) const;
  [[nodiscard]] const FieldLayout& layout() const { return layout_; }
  // By which what is looked up is multiplied: a power of two that keeps the largest number within half floats.
  [[nodiscard]] float scale() const { return scale_; }

 private:
  FieldLayout layout_;
  std::vector<gl::Texture> textures_;
  float scale_ = 1;
};

}  // namespace lightwell::render
