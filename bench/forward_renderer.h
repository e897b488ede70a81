// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lighting/light_set.h"
#include "render/camera.h"
#include "render/casters.h"
#include "render/gl_objects.h"
#include "render/picture.h"
#include "render/scene.h"

namespace lightwell::bench {

// Peer of the renderer: what it would be without its ideas. Every triangle goes into every light's shadow map, both faces;
// surfaces are shaded as they are drawn, hidden ones too, by a loop over all lights with a 2×2 comparison each. Lambertian.
// At most 256 lights.
class ForwardRenderer {
 public:
  static Result<ForwardRenderer> create(const render::Scene& scene, int width, int height, int shadow_size);
  void render(const LightSet& lights, const render::SceneCamera& camera);
  [[nodiscard]] render::RadiancePicture radiance() const;

 private:
  void draw_maps(int count);

  int width_ = 0;
  int height_ = 0;
  int map_size_ = 0;
  static constexpr int kTiles = 16;  // a side: room for 256 maps
  render::Sphere casters_;
  std::vector<render::Primitive> primitives_;
  std::vector<Rgb> albedos_;
  GLsizei caster_indices_ = 0;
  render::gl::Program maps_program_, surface_program_;
  render::gl::VertexArray vertices_array_, casters_array_;
  render::gl::Buffer vertices_, indices_, caster_indices_buffer_, lights_;
  render::gl::Texture maps_, colour_, depth_;
  render::gl::Framebuffer maps_target_, target_;
};

}  // namespace lightwell::bench
