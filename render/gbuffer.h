// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "render/camera.h"
#include "render/casters.h"
#include "render/gl_objects.h"
#include "render/scene.h"

namespace lightwell::render {

// Draws the scene into two textures: where each pixel's surface is, and what it is (gbuffer_fragment.glsl).
class GBuffer {
 public:
  static Result<GBuffer> create(const Scene& scene, const Casters& casters);
  // Takes the vertices of these primitives anew from the scene it was made of.
  void move(const Scene& scene, std::span<const std::size_t> moved);
  Status resize(int width, int height);
  void draw(const View& view);

  [[nodiscard]] GLuint position_material() const { return position_material_.id(); }
  [[nodiscard]] GLuint surface() const { return surface_.id(); }
  // 1 where no surface is.
  [[nodiscard]] GLuint depth() const { return depth_.id(); }
  // Two texels a material, 1024 texels a row: base colour and model; then specular and exponent, or metallic
  // and roughness.
  [[nodiscard]] GLuint materials() const { return materials_.id(); }

 private:
  struct Draw {
    Primitive primitive;
    float in_shadow_map = 0;
    GLuint base_color = 0;
    GLuint metallic_roughness = 0;
    bool double_sided = false;
  };

  int width_ = 0;
  int height_ = 0;
  std::vector<Draw> draws_;
  gl::Program program_;
  gl::VertexArray vertex_array_;
  gl::Buffer vertices_;
  gl::Buffer indices_;
  std::vector<gl::Texture> textures_;  // two a scene texture (sRGB, linear), then white
  gl::Texture materials_;
  gl::Texture position_material_;
  gl::Texture surface_;
  gl::Texture depth_;
  gl::Framebuffer framebuffer_;
};

}  // namespace lightwell::render
