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

// Draws the scene into textures: where each pixel's surface is, and what it is (gbuffer_fragment.glsl).
class GBuffer {
 public:
  static Result<GBuffer> create(const Scene& scene, const Casters& casters);
  // Takes the vertices of these primitives anew from the scene it was made of.
  void move(const Scene& scene, std::span<const std::size_t> moved);
  Status resize(int width, int height);
  void draw(const View& view);

  [[nodiscard]] GLuint position_material() const { return position_material_.id(); }
  [[nodiscard]] GLuint surface() const { return surface_.id(); }
  // Radiance that surfaces emit; 0 where no material of the scene does.
  [[nodiscard]] GLuint emission() const { return emission_.id(); }
  // 1 where no surface is.
  [[nodiscard]] GLuint depth() const { return depth_.id(); }
  // Two texels a material, 1024 texels a row: base colour and model; then specular and exponent, or metallic
  // and roughness.
  [[nodiscard]] GLuint materials() const { return materials_.id(); }
  // What shadow maps need of primitives with holes: Vertex and index buffer, and a texture with its alpha.
  [[nodiscard]] GLuint vertices() const { return vertices_.id(); }
  [[nodiscard]] GLuint indices() const { return indices_.id(); }
  [[nodiscard]] GLuint base_color(std::size_t primitive) const { return draws_[primitive].base_color; }

 private:
  struct Draw {
    Primitive primitive;
    Material material;
    float in_shadow_map = 0;
    bool detail = false;  // drawn with the program that knows textures
    GLuint base_color = 0;
    GLuint metallic_roughness = 0;
    GLuint normal = 0;
    GLuint emission = 0;
  };
  struct Program {
    gl::Program program;
    GLint material_number = -1;
    GLint in_shadow_map = -1;
  };
  Result<Program> make_program(bool detail) const;
  Status make_textures(const Scene& scene);
  void set_detail(const Draw& draw) const;

  int width_ = 0;
  int height_ = 0;
  std::vector<Draw> draws_;
  bool emits_ = false;
  Program plain_;
  Program detail_;
  gl::VertexArray vertex_array_;
  gl::Buffer vertices_;
  gl::Buffer indices_;
  std::vector<gl::Texture> textures_;
  gl::Texture materials_;
  gl::Texture position_material_;
  gl::Texture surface_;
  gl::Texture emission_;
  gl::Texture depth_;
  gl::Framebuffer framebuffer_;
};

}  // namespace lightwell::render
