// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/field_shading.h"

#include <algorithm>

#include "render/uniforms.h"

namespace lightwell::render {
namespace {

constexpr int kFirstFieldUnit = 6;
constexpr int kLobeUnit = kFirstFieldUnit + FieldLayout::kMostTextures;

bool has_power(const DirectionalLight& light) {
  return light.illuminance.maxCoeff() > 0;
}

LightSet light_set_of(const LightField& field, const MainLights& main) {
  LightSet set;
  for (std::size_t i = 0; i < main.directions.size(); ++i) {
    DirectionalLight light;
    light.direction = main.directions[i].cast<float>();
    for (int z = 0; z < field.grid.size[2]; ++z)
      for (int c = 0; c < 3; ++c) {
        const float* plane = main.plane(static_cast<int>(i), z, c, field.grid);
        light.illuminance[c] =
            std::max(light.illuminance[c], *std::max_element(plane, plane + field.slab_points()));
      }
    set.lights.push_back(light);
  }
  return set;
}

}  // namespace

FieldShading FieldShading::create(const MaterialKinds& kinds, bool nothing_casts, const ShadowLookUp& shadows,
                                  const std::string& facts) {
  FieldShading shading;
  shading.kinds_ = kinds;
  shading.facts_ = facts;
  shading.look_up_ = shadow_look_up(nothing_casts, shadows);
  shading.no_look_up_ = shadow_look_up(true, shadows);
  shading.light_block_ =
      gl::make_buffer(GL_UNIFORM_BUFFER, nullptr, kMaxLightsPerBlock * sizeof(LightRow), GL_DYNAMIC_DRAW);
  shading.no_vertices_ = gl::make_vertex_array();
  return shading;
}

Status FieldShading::set(const LightField& field, const MainLights& lights) {
  GLint side = 0;
  glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &side);
  auto layout =
      FieldLayout::create(field.grid, field.degree, static_cast<int>(lights.directions.size()), side);
  if (!layout) return layout.error();
  const bool another = !(*layout == textures_.layout());
  textures_.set_layout(*layout);
  textures_.fill(field, lights);
  light_set_ = light_set_of(field, lights);
  if (!another) return {};
  lobes_.make(kinds_, field.degree);
  const bool without_shadows = programs_[0].id() != 0;
  programs_ = {};
  if (Status s = make_if_missing(true); !s) return s;
  return without_shadows ? make_if_missing(false) : Status();
}

Status FieldShading::make_if_missing(bool shadows) {
  gl::Program& there = programs_[shadows ? 1 : 0];
  if (there.id() != 0 || textures_.layout().degree() == 0) return {};
  auto program =
      gl::make_program("fullscreen_vertex", "field_fragment",
                       facts_ + kinds_.facts() + (shadows ? look_up_ : no_look_up_) + lobes_.facts() +
                           textures_.layout().code(kinds_.lobes) + surface_code());
  if (!program) return program.error();
  there = std::move(program).value();
  glUniformBlockBinding(there.id(), glGetUniformBlockIndex(there.id(), "Lights"), 0);
  return {};
}

std::size_t FieldShading::lights_with_power() const {
  return static_cast<std::size_t>(
      std::count_if(light_set_.lights.begin(), light_set_.lights.end(), has_power));
}

int FieldShading::texture_units() const {
  return kFirstFieldUnit + textures_.layout().textures() + (kinds_.lobes ? 1 : 0);
}

void FieldShading::set_lights(std::span<const LightRow> lights, int shadow_page) {
  glBindBuffer(GL_UNIFORM_BUFFER, light_block_.id());
  glBufferSubData(GL_UNIFORM_BUFFER, 0, static_cast<GLsizeiptr>(lights.size_bytes()), lights.data());
  lights_ = static_cast<int>(lights.size());
  shadow_page_ = shadow_page;
  // The atlas may have put them into another order, and turned them by part of a texel.
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const Eigen::Map<const Vec3f> direction(lights[i].to_light);
    // Those without power have no row, wherever they point.
    const auto closeness = [&](const DirectionalLight& light) {
      return has_power(light) ? direction.dot(light.direction) : -2;
    };
    const auto nearest =
        std::max_element(light_set_.lights.begin(), light_set_.lights.end(),
                         [&](const auto& a, const auto& b) { return closeness(a) < closeness(b); });
    main_light_[i] = static_cast<GLint>(nearest - light_set_.lights.begin());
  }
}

void FieldShading::shade(bool shadows, const SurfaceShading::Sample& sample,
                         const SurfaceShading::Target& target, const GBuffer& gbuffer,
                         const ShadowAtlas& atlas, const Casters& casters) const {
  glViewport(0, 0, target.width, target.height);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_FALSE);
  glDepthFunc(GL_GREATER);  // the draw is at depth 1, where nothing is
  glBindVertexArray(no_vertices_.id());
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, light_block_.id());
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  const Uniforms surfaces(programs_[shadows ? 1 : 0]);
  surfaces.set_texture("so_far", 0, target.so_far);
  surfaces.set_texture("position_material_map", 1, gbuffer.position_material());
  surfaces.set_texture("surface_map", 2, gbuffer.surface());
  surfaces.set_texture("materials", 3, gbuffer.materials());
  surfaces.set_texture("shadow_maps", 4, atlas.texture(shadow_page_));
  surfaces.set_texture("emission_map", 5, gbuffer.emission());
  textures_.bind(kFirstFieldUnit);
  std::array<GLint, FieldLayout::kMostTextures> units{};
  for (std::size_t i = 0; i < units.size(); ++i) units[i] = kFirstFieldUnit + static_cast<GLint>(i);
  glUniform1iv(surfaces.place("field"), layout().textures(), units.data());
  if (kinds_.lobes) {
    lobes_.bind(kLobeUnit);
    surfaces.set("lobe_table", kLobeUnit);
  }
  const FieldGrid& grid = layout().grid();
  const Vec3f low = grid.low.cast<float>(), per_metre = grid.cell().cwiseInverse().cast<float>();
  const Vec3f last = Eigen::Map<const Eigen::Vector3i>(grid.size.data()).cast<float>() - Vec3f::Ones();
  const auto texels = layout().texture_size();
  const Vec3f size = Eigen::Map<const Eigen::Vector3i>(texels.data()).cast<float>();
  surfaces.set("grid_low", low.data());
  surfaces.set("grid_per_metre", per_metre.data());
  surfaces.set("grid_last", last.data());
  surfaces.set("texture_size", size.data());
  surfaces.set("field_scale", textures_.scale());
  surfaces.set("weight", sample.weight);
  surfaces.set("coverage", sample.first_block ? 1.0f : 0.0f);
  surfaces.set("start_sum", target.start_sum ? 1 : 0);
  surfaces.set("last_block", sample.last_block ? 1 : 0);
  surfaces.set("atlas_side", static_cast<float>(atlas.side()));
  surfaces.set("light_count", lights_);
  glUniform1iv(surfaces.place("main_light"), kMostMainLights, main_light_.data());
  surfaces.set("objects_centre", casters.objects.centre.data());
  surfaces.set("scene_centre", casters.scene.centre.data());
  surfaces.set("casters_off_texels", atlas.casters_off_texels());
  surfaces.set("eye", sample.view.eye.data());
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace lightwell::render
