// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/lamp_shading.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "render/shaders.h"

namespace lightwell::render {
namespace {

struct SourceRow {  // Source of lamp_fragment.glsl (std140)
  float place_low[4], fit[4];
};

bool shines(const PlacedLamp& lamp) {
  return lamp.dimming > 0;
}

// What a lamp lights, as it sees it.
std::vector<Vec3d> places_seen(const Receivers& receivers, const Eigen::Isometry3d& world_from_lamp) {
  const Eigen::Isometry3d lamp_from_world = world_from_lamp.inverse();
  std::vector<Vec3d> places;
  places.reserve(receivers.places().size());
  for (const Receivers::Place& place : receivers.places())
    places.push_back(lamp_from_world * place.point.cast<double>());
  return places;
}

// Where a lamp came to see what it lights another way, for the error of taking positions together: a place of it by a
// fiftieth of its distance, whichever of the two moved.
bool moved_much(const std::vector<Vec3d>& before, const std::vector<Vec3d>& now) {
  return !std::equal(before.begin(), before.end(), now.begin(), now.end(),
                     [](const Vec3d& a, const Vec3d& b) { return (b - a).norm() <= 0.02 * a.norm(); });
}

GLint wrap_across(SourceMap map) {
  return map == SourceMap::sphere ? GL_REPEAT : GL_CLAMP_TO_EDGE;
}

}  // namespace

LampShading LampShading::create(const Scene& scene, bool nothing_casts, const LampOptions& options) {
  LampShading shading;
  shading.options_ = options;
  shading.kinds_ = material_kinds(scene);
  shading.nothing_casts_ = nothing_casts;
  shading.receivers_ = Receivers(scene);
  shading.no_vertices_ = gl::make_vertex_array();
  return shading;
}

// Halves of images that are scaled so that the brightest pixel is 1: the least that is told apart is 6e-8 of it.
Result<LampShading::Part> LampShading::upload(LampSources sources) const {
  Part part;
  const bool grey = sources.is_grey();
  const float brightest = sources.brightest();
  std::vector<float> values;
  values.reserve(sources.pixels.size() * (grey ? 1 : 4));
  for (const Rgb& p : sources.pixels) {
    const Rgb scaled = p / brightest;
    if (grey)
      values.push_back(scaled[0]);
    else
      values.insert(values.end(), {scaled[0], scaled[1], scaled[2], 0.0f});
  }
  GLint side = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &side);
  if (sources.width > side || sources.height > side)
    return Error{ErrorKind::bad_input, "an image of " + std::to_string(sources.width) + "x" +
                                           std::to_string(sources.height) + " pixels, this driver allows " +
                                           std::to_string(side) + " a side"};
  const int levels = 1 + static_cast<int>(std::log2(std::max(sources.width, sources.height)));
  GLuint id = 0;
  glGenTextures(1, &id);
  part.images = gl::Texture(id);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D_ARRAY, id);
  const auto count = static_cast<GLsizei>(sources.sources.size());
  glTexStorage3D(GL_TEXTURE_2D_ARRAY, levels, grey ? GL_R16F : GL_RGBA16F, sources.width, sources.height,
                 count);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, 0, 0, 0, sources.width, sources.height, count,
                  grey ? GL_RED : GL_RGBA, GL_FLOAT, values.data());
  glGenerateMipmap(GL_TEXTURE_2D_ARRAY);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_S, wrap_across(sources.map));
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  if (grey)
    for (const GLenum channel : {GLenum{GL_TEXTURE_SWIZZLE_G}, GLenum{GL_TEXTURE_SWIZZLE_B}})
      glTexParameteri(GL_TEXTURE_2D_ARRAY, channel, GL_RED);
  if (glGetError() == GL_OUT_OF_MEMORY)
    return Error{ErrorKind::failed, "the driver has no memory for a lamp's images"};
  part.candela = Rgb::Constant(brightest);
  part.bytes = values.size() * 2 * 4 / 3;
  sources.pixels = {};
  part.sources = std::move(sources);
  part.block = gl::make_buffer(GL_UNIFORM_BUFFER, nullptr, kMostSources * sizeof(SourceRow), GL_DYNAMIC_DRAW);
  fill_block(part);
  return part;
}

void LampShading::fill_block(Part& part) const {
  std::vector<SourceRow> rows;
  const LampViews& views = part.maps.views();
  const auto faces = static_cast<std::size_t>(views.faces);
  for (std::size_t i = 0; i < part.sources.sources.size(); ++i) {
    const LampSources::Source& source = part.sources.sources[i];
    SourceRow row{{static_cast<float>(source.place.x()), static_cast<float>(source.place.y()),
                   static_cast<float>(source.low.x()), static_cast<float>(source.low.y())},
                  {0, 0, 0, 0}};
    // All faces of a cube have one fit, or none.
    for (std::size_t face = 0; face < faces && views.fits.size() > i * faces; ++face)
      if (const auto& fit = views.fits[i * faces + face]; fit[0] != 0)
        std::copy(fit.begin(), fit.end(), row.fit);
    rows.push_back(row);
  }
  glBindBuffer(GL_UNIFORM_BUFFER, part.block.id());
  glBufferSubData(GL_UNIFORM_BUFFER, 0, static_cast<GLsizeiptr>(rows.size() * sizeof(SourceRow)),
                  rows.data());
}

Status LampShading::choose_group(Drawn& drawn, const Casters& casters) {
  const Luminaire& lamp = *drawn.lamp.lamp;
  if (!lamp.near) return {};
  std::vector<Vec3d> seen = places_seen(receivers_, drawn.lamp.world_from_lamp);
  if (drawn.chosen && !moved_much(drawn.chosen_for, seen)) return {};
  if (!outlines_) outlines_.emplace(casters);
  const auto outlines = outlines_->seen_from(lamp_eye(*lamp.near, drawn.lamp.world_from_lamp), casters);
  const int group = drawn.detail.choose(*lamp.near, options_.max_error, {receivers_.places(), outlines},
                                        drawn.lamp.world_from_lamp, least_group(*lamp.near), drawn.group);
  drawn.chosen = true;
  drawn.chosen_for = std::move(seen);
  if (group == drawn.group) return {};
  drawn.group = group;
  drawn.near.reset();
  LampSources sources = sources_of(*lamp.near, group);
  if (sources.sources.empty()) return {};
  auto part = upload(std::move(sources));
  if (!part) return part.error();
  part->positions = lamp.near->intensity.planes.images();
  drawn.near.emplace(std::move(part).value());
  return {};
}

Status LampShading::set(std::span<const PlacedLamp> lamps, const Casters& casters) {
  while (lamps_.size() > lamps.size()) lamps_.pop_back();
  for (std::size_t i = 0; i < lamps.size(); ++i) {
    const PlacedLamp& lamp = lamps[i];
    if (i == lamps_.size() || lamps_[i].lamp.lamp != lamp.lamp) {
      Drawn fresh;
      fresh.lamp = lamp;
      if (lamp.lamp->near) fresh.detail = LampDetail(*lamp.lamp->near);
      if (lamp.lamp->far) {
        LampSources sources = sources_of(*lamp.lamp->far, far_centre(*lamp.lamp));
        if (!sources.sources.empty()) {
          auto part = upload(std::move(sources));
          if (!part) return part.error();
          fresh.far.emplace(std::move(part).value());
        }
      }
      if (i == lamps_.size())
        lamps_.push_back(std::move(fresh));
      else
        lamps_[i] = std::move(fresh);
    }
    Drawn& drawn = lamps_[i];
    if (!drawn.lamp.world_from_lamp.isApprox(lamp.world_from_lamp, 0))
      for (auto* part : {&drawn.near, &drawn.far})
        if (*part) (*part)->stale = true;
    drawn.lamp = lamp;
  }
  return choose_groups(casters);
}

Status LampShading::choose_groups(const Casters& casters) {
  for (Drawn& drawn : lamps_)
    if (shines(drawn.lamp))
      if (Status s = choose_group(drawn, casters); !s) return s;
  surfaces_moved_ = false;
  return {};
}

void LampShading::follow(const Scene& scene, float farthest_m) {
  receivers_.move(scene);
  surfaces_moved_ = true;
  for (Drawn& drawn : lamps_)
    for (auto* part : {&drawn.near, &drawn.far})
      if (*part) (*part)->stale = (*part)->maps.follow(farthest_m) || (*part)->stale;
}

Status LampShading::draw_maps(Drawn& drawn, Part& part, const AllCasters& all) {
  if (!part.stale) return {};
  // Meshes for small maps are a quarter of such a map's texel off: over the objects' diameter, as from far away.
  const double radius = static_cast<double>(all.coarse.objects.radius);
  const double away =
      (drawn.lamp.world_from_lamp.translation() - all.coarse.objects.centre.cast<double>()).norm();
  const bool fine =
      all.fine != nullptr &&
      (away < 3 * radius ||
       LampMaps::side_of(options_.shadow_size, part.sources.sources.size()) > options_.shadow_size);
  const double texels = options_.shadow_size * (fine ? kLargestMap : 1);
  const float off_m = options_.simplify_casters
                          ? static_cast<float>(static_cast<double>(kSimplifiedTexels) * 2 * radius / texels)
                          : 0;
  if (Status s = part.maps.draw(map_program_, part.sources, drawn.lamp.world_from_lamp,
                                {fine ? *all.fine : all.coarse,
                                 fine ? all.buffers.fine() : all.buffers.coarse(), all.cutouts, off_m},
                                options_.shadow_size);
      !s)
    return s;
  maps_drawn_ += part.maps.drawn();
  part.stale = false;
  fill_block(part);
  return {};
}

Status LampShading::draw_maps(const AllCasters& casters) {
  maps_drawn_ = 0;
  if (nothing_casts_) return {};
  if (map_program_.id() == 0) {
    auto program = LampMaps::make_program();
    if (!program) return program.error();
    map_program_ = std::move(program).value();
  }
  for (Drawn& drawn : lamps_) {
    if (!shines(drawn.lamp)) continue;
    for (auto* part : {&drawn.near, &drawn.far})
      if (*part)
        if (Status s = draw_maps(drawn, **part, casters); !s) return s;
  }
  return {};
}

std::pair<const LampShading::Drawn*, const LampShading::Part*> LampShading::pass(std::size_t number) const {
  for (const Drawn& drawn : lamps_) {
    if (!shines(drawn.lamp)) continue;
    for (const auto* part : {&drawn.near, &drawn.far})
      if (*part && number-- == 0) return {&drawn, &**part};
  }
  return {nullptr, nullptr};
}

std::size_t LampShading::passes() const {
  std::size_t count = 0;
  while (pass(count).second != nullptr) ++count;
  return count;
}

Result<const gl::Program*> LampShading::program(SourceMap map, int faces) {
  for (const Program& there : programs_)
    if (there.map == map && there.faces == faces) return &there.program;
  std::string facts =
      "#define PLANE 0\n#define HEMISPHERE 1\n#define SPHERE 2\n#define SOURCE_MAP " +
      std::to_string(static_cast<int>(map)) + "\n#define HAS_SHADOWS " + (faces > 0 ? "1" : "0") +
      "\n#define FACES " + std::to_string(faces) +
      // Depth: beyond the rounding of 24 bits, 3e-8, and of single precision, in the map and here.
      "\n#define DEPTH_SLACK 2.5e-7\n#define LEAST_COSINE 0.05\n" + kinds_.facts() + surface_code() +
      reflectance_code();
  if (faces > 0) facts += shadow_texel_code() + std::string(shader_text("lamp_shadow.glsl"));
  auto made = gl::make_program("fullscreen_vertex", "lamp_fragment", facts);
  if (!made) return made.error();
  glUniformBlockBinding(made->id(), glGetUniformBlockIndex(made->id(), "Sources"), 0);
  programs_.push_back({map, faces, std::move(made).value()});
  return &programs_.back().program;
}

Status LampShading::shade(std::size_t number, bool shadows, const SurfaceShading::Sample& sample,
                          const SurfaceShading::Target& target, const GBuffer& gbuffer) {
  const auto [drawn, part] = pass(number);
  verify_bug(part != nullptr, "no such pass");
  const LampSources& lamp = part->sources;
  const bool look_up = shadows && !nothing_casts_ && !part->maps.views().empty();
  const auto chosen = program(lamp.map, look_up ? part->maps.views().faces : 0);
  if (!chosen) return chosen.error();
  glViewport(0, 0, target.width, target.height);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_FALSE);
  glDepthFunc(GL_GREATER);  // the draw is at depth 1, where nothing is
  glBindVertexArray(no_vertices_.id());
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, part->block.id());
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  const Uniforms to(**chosen);
  to.set_texture("so_far", 0, target.so_far);
  to.set_texture("position_material_map", 1, gbuffer.position_material());
  to.set_texture("surface_map", 2, gbuffer.surface());
  to.set_texture("materials", 3, gbuffer.materials());
  if (look_up) part->maps.set_uniforms(to, 4);
  glActiveTexture(GL_TEXTURE0 + 5);
  glBindTexture(GL_TEXTURE_2D_ARRAY, part->images.id());
  to.set("images", 5);
  to.set("weight", sample.weight);
  to.set("eye", sample.view.eye.data());
  to.set("pixel_tangent",
         2 * sample.view.up.norm() / sample.view.forward.norm() / static_cast<float>(target.height));
  to.set("source_count", static_cast<int>(lamp.sources.size()));
  to.set("place_z", static_cast<float>(lamp.sources.front().place.z()));
  to.set("source_radius", static_cast<float>(lamp.radius_m));
  const Eigen::Matrix3f turn = drawn->lamp.world_from_lamp.linear().transpose().cast<float>();
  const Vec3f origin = drawn->lamp.world_from_lamp.translation().cast<float>();
  Vec3d middle = Vec3d::Zero();
  for (const LampSources::Source& source : lamp.sources)
    middle += source.place / static_cast<double>(lamp.sources.size());
  const Vec3f lamp_middle = middle.cast<float>();
  glUniformMatrix3fv(to.place("lamp_from_world"), 1, GL_FALSE, turn.data());
  to.set("lamp_origin", origin.data());
  to.set("lamp_middle", lamp_middle.data());
  const Rgb candela = part->candela * static_cast<float>(drawn->lamp.dimming);
  to.set("candela", candela.data());
  const Eigen::Vector2f per_span = lamp.span.cwiseInverse().cast<float>();
  glUniform2fv(to.place("per_span"), 1, per_span.data());
  const double pixels = lamp.map == SourceMap::plane ? std::sqrt(lamp.width * lamp.height / lamp.span.prod())
                        : lamp.map == SourceMap::hemisphere ? std::sqrt(lamp.width * lamp.height / (2 * kPi))
                                                            : (lamp.height - 1) / kPi;
  to.set("image_pixels", static_cast<float>(pixels));
  glDrawArrays(GL_TRIANGLES, 0, 3);
  return {};
}

LampShading::Counts LampShading::counts() const {
  Counts counts;
  for (const Drawn& drawn : lamps_) {
    if (!shines(drawn.lamp) || !(drawn.near || drawn.far)) continue;
    ++counts.lamps;
    for (const auto* part : {&drawn.near, &drawn.far}) {
      if (!*part) continue;
      counts.positions += (*part)->positions;
      counts.sources += (*part)->sources.sources.size();
      const auto side = static_cast<std::size_t>((*part)->maps.page_side());
      counts.bytes += (*part)->bytes + side * side * 4;
      for (const auto& fit : (*part)->maps.views().fits) counts.maps += fit[0] != 0 ? 1 : 0;
      if (const int map_side = (*part)->maps.side(); map_side > 0)
        counts.map_side = counts.map_side == 0 ? map_side : std::min(counts.map_side, map_side);
    }
  }
  counts.maps_drawn = maps_drawn_;
  return counts;
}

}  // namespace lightwell::render
