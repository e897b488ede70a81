// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "render/gbuffer.h"
#include "render/gl_objects.h"
#include "render/scene.h"
#include "render/shadow_atlas.h"

namespace lightwell::render {

// Casters with holes where their texture says so (leaves, fences): drawn into the shadow maps as the picture shows
// them, from the G-buffer's own vertices.
class CutoutCasters {
 public:
  static Result<CutoutCasters> create(const Scene& scene, const Casters& casters, const GBuffer& gbuffer);
  [[nodiscard]] bool empty() const { return draws_.empty(); }
  // Adds to the maps that the atlas has just drawn.
  void draw(const ShadowAtlas& atlas) const;
  // Adds to the map that is the viewport.
  void draw(const Mat4f& clip_from_world) const;

 private:
  struct Draw {
    Primitive primitive;
    TextureUse use;
    GLuint texture = 0;
    float alpha = 1;
    float alpha_cutoff = 0;
  };
  void draw_all(const gl::Program& program, GLsizei instances) const;
  std::vector<Draw> draws_;
  gl::Program program_, one_view_;
  gl::VertexArray vertex_array_, alone_;
};

}  // namespace lightwell::render
