// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/lamp_maps.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "render/shadow_atlas.h"

namespace lightwell::render {
namespace {

// Few sources have larger maps: of as many texels together as so many of the size that was asked for.
constexpr std::size_t kFullMaps = 16;
constexpr int kLeastSide = 16;

int columns_for(std::size_t maps) {
  return static_cast<int>(std::ceil(std::sqrt(static_cast<double>(maps))));
}

}  // namespace

Result<gl::Program> LampMaps::make_program() {
  return gl::make_program("shadow_vertex", "empty_fragment", "#define ONE_VIEW\n");
}

int LampMaps::side_of(int map_size, std::size_t maps) {
  int side = map_size;
  for (std::size_t wanted = maps; 4 * wanted <= kFullMaps && side < kLargestMap * map_size; wanted *= 4)
    side *= 2;
  const int limit = ShadowAtlas::side_limit();
  while (side > kLeastSide && columns_for(maps) * side > limit) side /= 2;
  return side;
}

Status LampMaps::make_page(std::size_t maps) {
  columns_ = columns_for(maps);
  const int page_side = columns_ * side_;
  if (page_side == page_side_) return {};
  page_ = gl::make_texture(GL_DEPTH_COMPONENT24, page_side, page_side);
  auto framebuffer = gl::make_framebuffer({}, page_.id());
  if (!framebuffer) return framebuffer.error();
  framebuffer_ = std::move(framebuffer).value();
  page_side_ = page_side;
  return {};
}

Status LampMaps::draw(const gl::Program& program, const LampSources& lamp,
                      const Eigen::Isometry3d& world_from_lamp, const LampCasters& casters, int map_size) {
  drawn_ = 0;
  moved_m_ = 0;
  off_m_ = casters.off_m;
  // The number of faces is known only once they are looked for, and asks for another side then.
  side_ = side_of(map_size, lamp.sources.size());
  views_ = find_lamp_views(lamp, world_from_lamp, casters.casters, side_);
  const std::size_t maps = std::max<std::size_t>(views_.fits.size(), 1);
  if (const int side = side_of(map_size, maps); side != side_) {
    side_ = side;
    views_ = find_lamp_views(lamp, world_from_lamp, casters.casters, side_);
  }
  if (Status s = make_page(maps); !s) return s;
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glClear(GL_DEPTH_BUFFER_BIT);
  for (std::size_t i = 0; i < views_.fits.size(); ++i) {
    if (views_.fits[i][0] == 0) continue;
    ++drawn_;
    const auto faces = static_cast<std::size_t>(views_.faces);
    const auto face = static_cast<int>(i % faces);
    const Mat4f clip = views_.clip_from_world(lamp, world_from_lamp, i / faces, face);
    glViewport(static_cast<int>(i) % columns_ * side_, static_cast<int>(i) / columns_ * side_, side_, side_);
    glUseProgram(program.id());
    glUniformMatrix4fv(gl::uniform(program, "clip_from_world"), 1, GL_FALSE, clip.data());
    if (views_.mirrors(face)) glFrontFace(GL_CW);
    const GLint supports = gl::uniform(program, "supports");
    glUniform1i(supports, 0);
    casters.buffers.bind_alone();
    casters.buffers.draw_objects(1, !views_.inside);
    glUniform1i(supports, 1);
    if (views_.with_supports) casters.buffers.draw_supports();
    casters.cutouts.draw(clip);
    glFrontFace(GL_CCW);
  }
  return {};
}

bool LampMaps::follow(float farthest_m) {
  moved_m_ += farthest_m;
  return static_cast<double>(moved_m_) >
         static_cast<double>(kMovedTexels) * views_.least_texel_m(std::max(side_, 1));
}

void LampMaps::set_uniforms(const Uniforms& uniforms, int unit) const {
  const auto terms = views_.depth_terms();
  glUniform2fv(uniforms.place("depth_terms"), 1, terms.data());
  uniforms.set_texture("shadow_maps", unit, page_.id());
  uniforms.set("atlas_side", static_cast<float>(page_side_));
  uniforms.set("map_texel", 1 / static_cast<float>(side_));
  uniforms.set("tile_side", static_cast<float>(side_) / static_cast<float>(page_side_));
  uniforms.set("tile_columns", columns_);
  uniforms.set("caster_slack", off_m_ + moved_m_);
  const Eigen::Matrix3f turn = views_.map_from_lamp.cast<float>();
  glUniformMatrix3fv(uniforms.place("map_from_lamp"), 1, GL_FALSE, turn.data());
}

}  // namespace lightwell::render
