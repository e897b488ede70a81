// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>

#include "lighting/light_set.h"
#include "render/field_textures.h"
#include "render/lobe_tables.h"
#include "render/surface_shading.h"

namespace lightwell::render {

// Lights the surfaces that a G-buffer shows by a light field: what each gathers of the harmonics at its place, less what is
// hidden of the field's main lights (field_fragment.glsl). With all main lights in sight, or without any, it is the field's
// light alone.
class FieldShading {
 public:
  // facts: text before the shader's own
  static FieldShading create(const MaterialKinds& kinds, bool nothing_casts, const ShadowLookUp& shadows,
                             const std::string& facts = "");
  // Another field; of the same grid and degree, with as many main lights, it costs only its upload.
  // bad_input: larger than the driver's 3D textures (FieldLayout)
  Status set(const LightField& field, const MainLights& lights);
  // For shade() with shadows = false.
  Status make_unshadowed() { return make_if_missing(false); }

  // The main lights as the shadow maps take them: each as strong as it is at its strongest.
  [[nodiscard]] const LightSet& main_lights() const { return light_set_; }
  [[nodiscard]] std::size_t lights_with_power() const;
  // Those that shade() takes away where they are hidden, with their maps, all on one page of the atlas.
  void set_lights(std::span<const LightRow> lights, int shadow_page);
  void shade(bool shadows, const SurfaceShading::Sample& sample, const SurfaceShading::Target& target,
             const GBuffer& gbuffer, const ShadowAtlas& atlas, const Casters& casters) const;

  [[nodiscard]] const FieldLayout& layout() const { return textures_.layout(); }
  [[nodiscard]] int texture_units() const;  // that it binds

 private:
  Status make_if_missing(bool shadows);
  MaterialKinds kinds_;
  std::string facts_, look_up_, no_look_up_;
  std::array<gl::Program, 2> programs_;  // [with shadows]
  FieldTextures textures_;
  LobeTables lobes_;
  LightSet light_set_;
  gl::Buffer light_block_;
  gl::VertexArray no_vertices_;
  int lights_ = 0;
  std::array<GLint, kMostMainLights> main_light_{};  // of each of them
  int shadow_page_ = 0;
};

}  // namespace lightwell::render
