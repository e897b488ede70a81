// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/renderer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "render/light_subsets.h"
#include "render/read_back.h"
#include "render/uniforms.h"

namespace lightwell::render {
namespace {

double now_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

// Hammersley points, centred: one sample is the pixel's centre.
Vec2f sample_offset(int index, int count) {
  if (count == 1) return Vec2f::Zero();
  double reversed = 0;
  double digit = 0.5;
  for (int i = index; i > 0; i /= 2, digit /= 2) reversed += (i % 2) * digit;
  // Half a step of the reversed digits' own grid centres them as well.
  const double half_step = 0.5 / std::exp2(std::ceil(std::log2(count)));
  return {static_cast<float>((index + 0.5) / count - 0.5), static_cast<float>(reversed + half_step - 0.5)};
}

}  // namespace

Result<Renderer> Renderer::create(const Scene& scene, const RendererOptions& options) {
  Renderer r;
  r.options_ = options;
  ShadowAtlasOptions atlas_options{options.shadow_size, options.texels_by_power};
  r.find_casters(scene, ShadowAtlas::has_large_maps(atlas_options));
  auto gbuffer = GBuffer::create(scene, r.casters_);
  if (!gbuffer) return gbuffer.error();
  r.fitted_objects_ = r.casters_.objects;
  r.fitted_scene_ = r.casters_.scene;
  auto atlas = ShadowAtlas::create(r.casters_, r.fine_casters_, atlas_options);
  if (!atlas) return atlas.error();
  auto cutouts = CutoutCasters::create(scene, r.casters_, *gbuffer);
  if (!cutouts) return cutouts.error();
  r.nothing_casts_ = atlas->empty() && cutouts->empty();
  auto tone_mapper = ToneMapper::create();
  if (!tone_mapper) return tone_mapper.error();
  auto surfaces = SurfaceShading::create(
      scene, r.nothing_casts_, {{options.simplify_casters, options.soft_edges}, options.interleave});
  if (!surfaces) return surfaces.error();
  if (Status s = surfaces->use_light_lists(options.light_lists); !s) return s.error();
  r.kinds_ = material_kinds(scene);
  r.lamps_ = LampShading::create(scene, r.nothing_casts_,
                                 {options.shadow_size, options.simplify_casters, options.lamp_error});
  if (options.field_balls) {
    auto balls = FieldBalls::create(*options.field_balls, scene.materials.size() - 1, r.kinds_.emission);
    if (!balls) return balls.error();
    r.balls_.emplace(std::move(balls).value());
  }
  auto background = gl::make_program("fullscreen_vertex", "background_fragment");
  if (!background) return background.error();
  r.gbuffer_ = std::move(gbuffer).value();
  r.atlas_ = std::move(atlas).value();
  r.cutouts_ = std::move(cutouts).value();
  r.tone_mapper_ = std::move(tone_mapper).value();
  r.surfaces_ = std::move(surfaces).value();
  r.background_ = std::move(background).value();
  r.no_vertices_ = gl::make_vertex_array();
  r.environment_ = gl::make_texture(GL_RGBA32F, 1, 1);
  const int width = std::exchange(r.options_.width, 0);
  if (Status s = r.resize(width, options.height); !s) return s.error();
  return r;
}

void Renderer::find_casters(const Scene& scene, bool fine_ones) {
  const int size = options_.simplify_casters ? options_.shadow_size : 0;
  std::vector<int> sizes = {size};
  if (fine_ones) sizes.insert(sizes.begin(), kLargestMap * size);
  auto levels = render::find_casters(scene, sizes);
  casters_ = std::move(levels.back());
  if (fine_ones) fine_casters_ = std::move(levels.front());
}

namespace {

// What maps were fitted to still holds what there is: within the padding of their depths, and not much too large for it.
bool holds(const Sphere& fitted, const Sphere& now) {
  constexpr float kRoom = 0.8f * (kDepthPadding - 1), kShrunk = 0.05f;
  return (now.centre - fitted.centre).norm() + now.radius <= (1 + kRoom) * fitted.radius &&
         now.radius >= (1 - kShrunk) * fitted.radius;
}

}  // namespace

void Renderer::move(const Scene& scene, std::span<const std::size_t> moved) {
  if (moved.empty()) return;
  gbuffer_.move(scene, moved);
  const float farthest = casters_.farthest_move(scene, moved);
  casters_.move(scene, moved);
  if (options_.texels_by_power) fine_casters_.move(scene, moved);
  lamps_.follow(scene, farthest);
  if (holds(fitted_objects_, casters_.objects) && holds(fitted_scene_, casters_.scene)) {
    for (Casters* casters : {&casters_, &fine_casters_}) {
      casters->objects = fitted_objects_;
      casters->scene = fitted_scene_;
    }
    atlas_.follow(casters_, fine_casters_, farthest);
    return;
  }
  fitted_objects_ = casters_.objects;
  fitted_scene_ = casters_.scene;
  atlas_.follow(casters_, fine_casters_, std::numeric_limits<float>::infinity());
}

Renderer::LostShadows Renderer::lost_shadows() const {
  LostShadows lost;
  lost.texel_m = 2 * casters_.objects.radius / static_cast<float>(kLargestMap * options_.shadow_size);
  for (const Casters::Part& part : casters_.parts) {
    if (casters_.is_support[part.primitive] || !(part.bounds.radius > 0)) continue;
    ++lost.of;
    if (2 * part.bounds.radius < lost.texel_m) ++lost.objects;
  }
  return lost;
}

Status Renderer::resize(int width, int height) {
  if (width == options_.width && height == options_.height) return {};
  options_.width = width;
  options_.height = height;
  if (Status s = gbuffer_.resize(width, height); !s) return s;
  if (Status s = surfaces_.resize(width, height, gbuffer_.depth()); !s) return s;
  if (Status s = tone_mapper_.resize(width, height); !s) return s;
  if (compositor_) {
    if (Status s = compositor_->resize(width, height); !s) return s;
    if (Status s = resize(unshadowed_sums_); !s) return s;
  }
  return resize(sums_);
}

Status Renderer::resize(Sums& sums) const {
  for (Sum& sum : sums.sum) {
    sum.texture = gl::make_texture(GL_RGBA32F, options_.width, options_.height);
    auto framebuffer = gl::make_framebuffer({sum.texture.id()}, gbuffer_.depth());
    if (!framebuffer) return framebuffer.error();
    sum.framebuffer = std::move(framebuffer).value();
  }
  return {};
}

Status Renderer::set_shadows(bool on) {
  shadows_ = on;
  if (on) return {};
  return field_ ? field_->make_unshadowed() : surfaces_.make_unshadowed();
}

Status Renderer::set_field(const LightField& field, const MainLights& main_lights) {
  if (field_) {
    if (Status s = field_->set(field, main_lights); !s) return s;
  } else {
    auto shading =
        FieldShading::create(kinds_, nothing_casts_, {options_.simplify_casters, options_.soft_edges});
    if (Status s = shading.set(field, main_lights); !s) return s;
    field_ = std::move(shading);
  }
  if (balls_) balls_->set_grid(field.grid);
  return compositor_ || !shadows_ ? field_->make_unshadowed() : Status();
}

Status Renderer::set_lamps(std::span<const PlacedLamp> lamps) {
  return lamps_.set(lamps, casters_);
}

Status Renderer::set_plate(const Plate& plate, float white) {
  if (!compositor_) {
    auto compositor = Compositor::create();
    if (!compositor) return compositor.error();
    if (Status s = field_ ? field_->make_unshadowed() : surfaces_.make_unshadowed(); !s) return s;
    compositor_.emplace(std::move(compositor).value());
    if (Status s = compositor_->resize(options_.width, options_.height); !s) return s;
    if (Status s = resize(unshadowed_sums_); !s) return s;
  }
  compositor_->set_plate(plate, white);
  return {};
}

Renderer::Shown Renderer::shown() const {
  if (compositor_) return {compositor_->picture(), compositor_->framebuffer()};
  return {sums_.last().texture.id(), sums_.last().framebuffer.id()};
}

void Renderer::set_environment(const LatLongImage* image) {
  show_environment_ = image != nullptr;
  if (image == nullptr) return;
  // Columns and rows left out evenly where the driver's textures are smaller.
  const int step = 1 + (std::max(image->width, image->height) - 1) / size_limit();
  const int width = (image->width + step - 1) / step;
  const int height = (image->height + step - 1) / step;
  std::vector<float> rgba;
  rgba.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Rgb& c = image->at(x * step, y * step);
      rgba.insert(rgba.end(), {c[0], c[1], c[2], 1.0f});
    }
  environment_ = gl::make_texture(GL_RGBA32F, width, height);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, GL_RGBA, GL_FLOAT, rgba.data());
}

double Renderer::lap(double start, double& pass) const {
  if (!options_.measure_passes) return start;
  glFinish();
  const double end = now_ms();
  pass += end - start;
  return end;
}

Status Renderer::render(const LightSet& given, const SceneCamera& camera, double environment_turn_rad) {
  times_ = {};
  const LightSet& lights = field_ ? field_->main_lights() : given;
  std::vector<LightRow> rows = make_light_rows(lights.lights, casters_);
  shadow_maps_ = nothing_casts_ ? 0 : rows.size();
  shadow_maps_drawn_ = 0;
  if (Status s = lamps_.follow_detail(casters_); !s) return s;
  if (Status s = draw_lamp_maps(); !s) return s;
  const int samples = options_.samples;
  // A plate is seen through each sample, so that its sum over the lights must be known first.
  const int at_once = compositor_ ? 1 : samples;
  for (int first = 0; first < samples; first += at_once) {
    if (Status s = render_samples(rows, lights, camera, first, first + at_once, environment_turn_rad); !s)
      return s;
    if (!compositor_) continue;
    const double start = now_ms();
    compositor_->add(sums_.last().texture.id(), unshadowed_sums_.last().texture.id(), gbuffer_.surface(),
                     1 / static_cast<float>(samples), first == 0);
    lap(start, times_.shading_ms);
  }
  return check();
}

Status Renderer::render_samples(std::span<LightRow> all, const LightSet& lights, const SceneCamera& camera,
                                int first_sample, int end_sample, double environment_turn_rad) {
  const int samples = end_sample - first_sample;
  const float weight = 1 / static_cast<float>(samples);
  double time = now_ms();
  bool start_sum = true;
  // At least once, so that ambient light and background are drawn without any light.
  for (std::size_t first = 0; first == 0 || first < all.size(); first += atlas_.capacity()) {
    const auto turn = all.subspan(first, std::min(atlas_.capacity(), all.size() - first));
    const auto blocks = blocks_of(turn);
    if (!blocks) return blocks.error();
    for (const ShadowAtlas::Block& block : *blocks) {
      const auto rows = turn.subspan(block.first, block.count);
      const bool first_block = first == 0 && block.first == 0;
      time = lap(time, times_.shadow_ms);
      const bool last_block = &block == &blocks->back() && first + turn.size() == all.size();
      if (field_)
        field_->set_lights(rows, block.page);
      else
        surfaces_.set_lights(rows, all, block.page);
      for (int sample = first_sample; sample < end_sample; ++sample) {
        const View view =
            make_view(camera, options_.width, options_.height, sample_offset(sample, options_.samples));
        // With one sample a pixel the G-buffer of the first block serves all blocks.
        if (first_block || samples > 1) {
          gbuffer_.draw(view);
          if (field_balls() > 0) balls_->draw(view);
        }
        time = lap(time, times_.gbuffer_ms);
        const SurfaceShading::Sample of_view{view, lights.ambient, first_block, last_block, weight};
        shade(of_view, start_sum, environment_turn_rad);
        start_sum = false;
        if (first_block)
          if (Status s = shade_lamps(of_view); !s) return s;
        time = lap(time, times_.shading_ms);
      }
    }
  }
  return {};
}

// Rows that are shaded at once, with their shadow maps drawn; one block of none where there are none.
Result<std::vector<ShadowAtlas::Block>> Renderer::blocks_of(std::span<LightRow> rows) {
  std::vector<ShadowAtlas::Block> blocks;
  if (!nothing_casts_ && shadows_ && !rows.empty()) {
    auto drawn = atlas_.draw(rows, casters_, fine_casters_);
    if (!drawn) return drawn.error();
    cutouts_.draw(atlas_);
    shadow_maps_drawn_ += atlas_.drawn();
    return drawn;
  }
  std::size_t first = 0;
  do {
    const auto count = std::min<std::size_t>(kMaxLightsPerBlock, rows.size() - first);
    blocks.push_back({0, first, count});
    first += count;
  } while (first < rows.size());
  return blocks;
}

Status Renderer::draw_lamp_maps() {
  if (!shadows_ || nothing_casts_) return {};
  const double start = now_ms();
  const bool has_fine = ShadowAtlas::has_large_maps({options_.shadow_size, options_.texels_by_power});
  if (Status s = lamps_.draw_maps({casters_, has_fine ? &fine_casters_ : nullptr, atlas_, cutouts_}); !s)
    return s;
  const LampShading::Counts counts = lamps_.counts();
  shadow_maps_ += counts.maps;
  shadow_maps_drawn_ += counts.maps_drawn;
  lap(start, times_.shadow_ms);
  return {};
}

void Renderer::shade(const SurfaceShading::Sample& sample, bool start_sum, double environment_turn_rad) {
  const GLuint so_far = sums_.last().texture.id();
  if (compositor_) shade_surfaces(false, unshadowed_sums_, sample, start_sum);
  shade_surfaces(shadows_, sums_, sample, start_sum);
  draw_background(so_far, sample, start_sum, show_environment_ && sample.first_block, environment_turn_rad);
}

Status Renderer::shade_lamps(const SurfaceShading::Sample& sample) {
  for (std::size_t pass = 0; pass < lamps_.passes(); ++pass)
    for (const bool unshadowed : {true, false}) {
      if (unshadowed && !compositor_) continue;
      Sums& sums = unshadowed ? unshadowed_sums_ : sums_;
      const GLuint so_far = sums.last().texture.id();
      sums.current = 1 - sums.current;
      const SurfaceShading::Target target{sums.last().framebuffer.id(), so_far, false, width(), height()};
      if (Status s = lamps_.shade(pass, shadows_ && !unshadowed, sample, target, gbuffer_); !s) return s;
      if (!unshadowed) draw_background(so_far, sample, false, false, 0);
    }
  return {};
}

// To the framebuffer that the surfaces were drawn to.
void Renderer::draw_background(GLuint so_far, const SurfaceShading::Sample& sample, bool start_sum,
                               bool show_environment, double environment_turn_rad) const {
  const Uniforms background(background_);
  background.set_texture("so_far", 0, so_far);
  background.set_texture("environment", 1, environment_.id());
  background.set("weight", sample.weight);
  background.set("start_sum", start_sum ? 1 : 0);
  background.set("show_environment", show_environment ? 1 : 0);
  background.set("environment_turns",
                 static_cast<float>(std::remainder(environment_turn_rad / (2 * kPi), 1.0)));
  background.set("view_forward", sample.view.forward.data());
  background.set("view_right", sample.view.right.data());
  background.set("view_up", sample.view.up.data());
  glDepthFunc(GL_EQUAL);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDepthFunc(GL_LESS);
}

void Renderer::shade_surfaces(bool shadows, Sums& sums, const SurfaceShading::Sample& sample,
                              bool start_sum) const {
  const GLuint so_far = sums.last().texture.id();
  sums.current = 1 - sums.current;
  const SurfaceShading::Target target{sums.last().framebuffer.id(), so_far, start_sum, width(), height()};
  if (field_)
    field_->shade(shadows, sample, target, gbuffer_, atlas_, casters_);
  else
    surfaces_.shade(shadows, sample, target, gbuffer_, atlas_, casters_);
}

Status Renderer::lay_over(const RadiancePicture& picture, int left, int bottom) {
  if (lay_over_.id() == 0) {
    auto program = gl::make_program("fullscreen_vertex", "lay_over_fragment");
    if (!program) return program.error();
    lay_over_ = std::move(program).value();
  }
  const gl::Texture texture = gl::make_texture(GL_RGBA32F, picture.width, picture.height);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, picture.width, picture.height, GL_RGBA, GL_FLOAT,
                  picture.rgba.data());
  glBindFramebuffer(GL_FRAMEBUFFER, shown().framebuffer);
  glViewport(left, bottom, picture.width, picture.height);
  glDisable(GL_DEPTH_TEST);
  const Uniforms over(lay_over_);
  over.set_texture("over_map", 0, texture.id());
  glUniform2i(over.place("corner"), left, bottom);
  glBindVertexArray(no_vertices_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  return {};
}

void Renderer::tone_map(ToneMap operation, double dt_s) {
  Look look = tone_mapper_.look();
  look.operation = operation;
  tone_mapper_.set_look(look);
  tone_map(dt_s);
}

void Renderer::tone_map(double dt_s) {
  const double start = now_ms();
  if (compositor_) tone_mapper_.set_plate(compositor_->graded_plate());
  tone_mapper_.adapt(shown().texture, dt_s);
  tone_mapper_.draw(shown().texture);
  lap(start, times_.tonemap_ms);
}

RadiancePicture Renderer::radiance() const {
  return {width(), height(), read_back<float>(shown().framebuffer, width(), height())};
}

std::string Renderer::gl_renderer() {
  return reinterpret_cast<const char*>(glGetString(GL_RENDERER));
}

int Renderer::size_limit() {
  GLint limit = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
  return limit;
}

}  // namespace lightwell::render
