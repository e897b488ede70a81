// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "render/caster_buffers.h"
#include "render/cutout_casters.h"
#include "render/lamp_views.h"
#include "render/uniforms.h"

namespace lightwell::render {

// What casts, as a lamp's maps are to show it.
struct LampCasters {
  const Casters& casters;
  const CasterBuffers& buffers;
  const CutoutCasters& cutouts;
  float off_m = 0;  // how far they may be from what is seen
};

// The shadow maps of one lamp's sources: tiles of a depth texture of its own, for 24 bits are what a perspective asks for
// (docs/decisions/072-lamps-in-the-renderer.md).
class LampMaps {
 public:
  // The program that draws maps; shared by all lamps.
  static Result<gl::Program> make_program();
  // Texels a side of each of so many maps: map_size, more for few sources, less where they do not fit on one texture.
  static int side_of(int map_size, std::size_t maps);

  // Draws all maps anew.    failed: what the driver cannot do
  Status draw(const gl::Program& program, const LampSources& lamp, const Eigen::Isometry3d& world_from_lamp,
              const LampCasters& casters, int map_size);
  // Casters moved by so much at most: true where that adds up to kMovedTexels, so that draw() is due.
  bool follow(float farthest_m);
  [[nodiscard]] const LampViews& views() const { return views_; }
  [[nodiscard]] int side() const { return side_; }            // of a map, texels
  [[nodiscard]] int page_side() const { return page_side_; }  // of the texture
  [[nodiscard]] std::size_t drawn() const { return drawn_; }  // maps, by the last draw()
  // What lamp_shadow.glsl asks for.
  void set_uniforms(const Uniforms& uniforms, int unit) const;

 private:
  Status make_page(std::size_t maps);
  LampViews views_;
  int side_ = 0, columns_ = 1, page_side_ = 0;
  float off_m_ = 0;    // when they were drawn
  float moved_m_ = 0;  // since
  std::size_t drawn_ = 0;
  gl::Texture page_;
  gl::Framebuffer framebuffer_;
};

}  // namespace lightwell::render
