// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/surface_shading.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "render/light_subsets.h"
#include "render/shaders.h"
#include "render/shading_facts.h"
#include "render/uniforms.h"

namespace lightwell::render {
namespace {

constexpr const char* kPasses = "#define WHOLE 0\n#define SUBSETS 1\n#define FILTERED 2\n";

// What counts as one surface, and what is left to the filter: chosen by the error on the judged pictures against the time.
std::string filter_facts(int interleave) {
  const std::string least_found = interleave == 2 ? "1.0" : "0.8";  // of the subsets
  return "#define INTERLEAVE " + std::to_string(interleave) + "\n#define LEAST_FOUND " + least_found +
         "\n#define SAME_NORMAL 0.9\n"     // 26 degrees
         "#define SAME_PLANE 2.0\n"        // pixels
         "#define WIDEST_EXPONENT 50.0\n"  // narrower lobes change within the window
         "#define LEAST_ALPHA2 0.01\n";
}

Status add(gl::Program& made, const std::string& defines) {
  auto program = gl::make_program("fullscreen_vertex", "shade_fragment", defines);
  if (!program) return program.error();
  made = std::move(program).value();
  glUniformBlockBinding(made.id(), glGetUniformBlockIndex(made.id(), "Lights"), 0);
  return {};
}

}  // namespace

Result<SurfaceShading::Programs> SurfaceShading::make_programs(bool shadows, bool lists) const {
  Programs made;
  const std::string facts = kPasses + models_ + (shadows ? look_up_ : no_look_up_) + "#define LIGHT_LISTS " +
                            (lists ? "1\n" + LightLists::facts() : "0\n") + surface_code() +
                            reflectance_code();
  if (Status s = add(made.whole, facts + "#define LIGHT_PASS WHOLE\n"); !s) return s.error();
  if (interleave_ == 1) return made;
  const std::string filter = filter_facts(interleave_) + std::string(shader_text("interleave.glsl"));
  if (Status s = add(made.subsets, facts + "#define LIGHT_PASS SUBSETS\n" + filter); !s) return s.error();
  if (Status s = add(made.filtered, facts + "#define LIGHT_PASS FILTERED\n" + filter); !s) return s.error();
  return made;
}

Result<SurfaceShading> SurfaceShading::create(const Scene& scene, bool nothing_casts,
                                              const ShadingOptions& options) {
  SurfaceShading shading;
  shading.interleave_ = options.interleave;
  shading.models_ = material_kinds(scene).facts();
  shading.look_up_ = shadow_look_up(nothing_casts, options.shadows);
  shading.no_look_up_ = shadow_look_up(true, options.shadows);
  if (Status s = shading.make_if_missing(true, false); !s) return s.error();
  shading.light_block_ =
      gl::make_buffer(GL_UNIFORM_BUFFER, nullptr, kMaxLightsPerBlock * sizeof(LightRow), GL_DYNAMIC_DRAW);
  shading.no_vertices_ = gl::make_vertex_array();
  return shading;
}

Status SurfaceShading::make_if_missing(bool shadows, bool lists) {
  Programs& there = programs_[shadows ? 1 : 0][lists ? 1 : 0];
  if (there.whole.id() != 0) return {};
  auto programs = make_programs(shadows, lists);
  if (!programs) return programs.error();
  there = std::move(programs).value();
  return {};
}

Status SurfaceShading::make_unshadowed() {
  return make_if_missing(false, lists_);
}

Status SurfaceShading::use_light_lists(bool on) {
  for (const bool shadows : {false, true}) {
    if (programs_[shadows ? 1 : 0][lists_ ? 1 : 0].whole.id() == 0) continue;
    if (Status s = make_if_missing(shadows, on); !s) return s;
  }
  lists_ = on;
  return {};
}

Status SurfaceShading::resize(int width, int height, GLuint depth) {
  width_ = width;
  height_ = height;
  if (interleave_ == 1) return {};
  subsets_ = gl::make_texture(GL_RGBA32UI, width, height);
  auto framebuffer = gl::make_framebuffer({subsets_.id()}, depth);
  if (!framebuffer) return framebuffer.error();
  subsets_target_ = std::move(framebuffer).value();
  return {};
}

void SurfaceShading::set_lights(std::span<const LightRow> lights, std::span<const LightRow> all,
                                int shadow_page) {
  std::vector<LightRow> rows(lights.begin(), lights.end());
  const std::size_t strong = arrange_subsets(rows, all, interleave_);
  glBindBuffer(GL_UNIFORM_BUFFER, light_block_.id());
  glBufferSubData(GL_UNIFORM_BUFFER, 0, static_cast<GLsizeiptr>(rows.size() * sizeof(LightRow)), rows.data());
  if (lists_) light_lists_.set(rows, strong, interleave_ * interleave_);
  shadow_page_ = shadow_page;
  lights_ = static_cast<int>(rows.size());
  strong_ = static_cast<int>(strong);
  weak_illuminance_ = Rgb::Zero();
  for (std::size_t i = strong; i < rows.size(); ++i)
    weak_illuminance_ += Eigen::Map<const Rgb>(rows[i].illuminance);
  // A channel may have no light: what the shaders divide by it stays finite, and 0.
  weak_illuminance_ = weak_illuminance_.max(1e-30f);
}

void SurfaceShading::shade(bool shadows, const Sample& sample, const Target& target, const GBuffer& gbuffer,
                           const ShadowAtlas& atlas, const Casters& casters) const {
  const Programs& programs = programs_[shadows ? 1 : 0][lists_ ? 1 : 0];
  glViewport(0, 0, target.width, target.height);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_FALSE);
  glDepthFunc(GL_GREATER);  // the draw is at depth 1, where nothing is
  glBindVertexArray(no_vertices_.id());
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, light_block_.id());
  const bool interleaved = strong_ < lights_;
  if (interleaved) {
    glBindFramebuffer(GL_FRAMEBUFFER, subsets_target_.id());
    const GLuint nothing[4] = {0, 0, 0, 0};
    glClearBufferuiv(GL_COLOR, 0, nothing);
    draw(programs.subsets, sample, gbuffer, atlas, casters);
  }
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  const gl::Program& program = interleaved ? programs.filtered : programs.whole;
  const Uniforms surfaces(program);
  surfaces.set_texture("so_far", 0, target.so_far);
  surfaces.set_texture("emission_map", 5, gbuffer.emission());
  surfaces.set("weight", sample.weight);
  surfaces.set("coverage", sample.first_block ? 1.0f : 0.0f);
  surfaces.set("start_sum", target.start_sum ? 1 : 0);
  surfaces.set("ambient", sample.ambient.data());
  if (interleaved) surfaces.set_texture("subset_map", 6, subsets_.id());
  draw(program, sample, gbuffer, atlas, casters);
}

void SurfaceShading::draw(const gl::Program& program, const Sample& sample, const GBuffer& gbuffer,
                          const ShadowAtlas& atlas, const Casters& casters) const {
  const View& view = sample.view;
  const Uniforms surfaces(program);
  surfaces.set_texture("position_material_map", 1, gbuffer.position_material());
  surfaces.set_texture("surface_map", 2, gbuffer.surface());
  surfaces.set_texture("materials", 3, gbuffer.materials());
  surfaces.set_texture("shadow_maps", 4, atlas.texture(shadow_page_));
  if (lists_) surfaces.set_texture("light_lists", 7, light_lists_.texture());
  surfaces.set("atlas_side", static_cast<float>(atlas.side()));
  surfaces.set("light_count", lights_);
  surfaces.set("objects_centre", casters.objects.centre.data());
  surfaces.set("scene_centre", casters.scene.centre.data());
  surfaces.set("casters_off_texels", atlas.casters_off_texels());
  surfaces.set("eye", view.eye.data());
  if (strong_ < lights_) {
    const Vec3f axis = view.up.cross(view.right).normalized();
    surfaces.set("strong_count", strong_);
    surfaces.set("weak_illuminance", weak_illuminance_.data());
    surfaces.set("view_axis", axis.data());
    surfaces.set("view_forward", view.forward.data());
    surfaces.set("view_right", view.right.data());
    surfaces.set("view_up", view.up.data());
  }
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace lightwell::render
