// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/renderer.h"

#include <algorithm>
#include <chrono>
#include <cmath>

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

// Only the models that the scene's materials use are compiled.
std::string shading_models(const Scene& scene) {
  const auto uses = [&](Material::Model model) {
    return std::any_of(scene.materials.begin(), scene.materials.end(),
                       [=](const Material& m) { return m.model == model; });
  };
  return std::string("#define HAS_PHONG ") + (uses(Material::Model::phong) ? "1" : "0") +
         "\n#define HAS_METALLIC_ROUGHNESS " + (uses(Material::Model::metallic_roughness) ? "1" : "0") + "\n";
}

}  // namespace

Result<Renderer> Renderer::create(const Scene& scene, const RendererOptions& options) {
  Renderer r;
  r.options_ = options;
  r.casters_ = find_casters(scene);
  auto gbuffer = GBuffer::create(scene, r.casters_);
  if (!gbuffer) return gbuffer.error();
  auto atlas = ShadowAtlas::create(r.casters_, options.shadow_size);
  if (!atlas) return atlas.error();
  auto tone_mapper = ToneMapper::create();
  if (!tone_mapper) return tone_mapper.error();
  auto program = gl::make_program("fullscreen_vertex", "shade_fragment", shading_models(scene));
  if (!program) return program.error();
  r.gbuffer_ = std::move(gbuffer).value();
  r.atlas_ = std::move(atlas).value();
  r.tone_mapper_ = std::move(tone_mapper).value();
  r.program_ = std::move(program).value();
  glUniformBlockBinding(r.program_.id(), glGetUniformBlockIndex(r.program_.id(), "Lights"), 0);
  r.light_block_ =
      gl::make_buffer(GL_UNIFORM_BUFFER, nullptr, kMaxLightsPerBlock * sizeof(LightRow), GL_DYNAMIC_DRAW);
  r.no_vertices_ = gl::make_vertex_array();
  r.environment_ = gl::make_texture(GL_RGBA32F, 1, 1);
  const int width = std::exchange(r.options_.width, 0);
  if (Status s = r.resize(width, options.height); !s) return s.error();
  return r;
}

Status Renderer::resize(int width, int height) {
  if (width == options_.width && height == options_.height) return {};
  options_.width = width;
  options_.height = height;
  if (Status s = gbuffer_.resize(width, height); !s) return s;
  if (Status s = tone_mapper_.resize(width, height); !s) return s;
  for (Sum& sum : sums_) {
    sum.texture = gl::make_texture(GL_RGBA32F, width, height);
    auto framebuffer = gl::make_framebuffer({sum.texture.id()}, 0);
    if (!framebuffer) return framebuffer.error();
    sum.framebuffer = std::move(framebuffer).value();
  }
  return {};
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

Status Renderer::render(const LightSet& lights, const SceneCamera& camera, double environment_turn_rad) {
  times_ = {};
  const std::vector<LightRow> rows = make_light_rows(lights.lights, casters_, options_.shadow_size);
  const std::span<const LightRow> all(rows);
  shadow_maps_ = atlas_.empty() ? 0 : rows.size();
  const auto capacity = static_cast<std::size_t>(atlas_.capacity());
  double time = now_ms();
  bool start_sum = true;
  // At least once, so that ambient light and background are drawn without any light.
  for (std::size_t first = 0; first == 0 || first < all.size(); first += capacity) {
    const auto block = all.subspan(first, std::min(capacity, all.size() - first));
    glBindBuffer(GL_UNIFORM_BUFFER, light_block_.id());
    glBufferSubData(GL_UNIFORM_BUFFER, 0, static_cast<GLsizeiptr>(block.size_bytes()), block.data());
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, light_block_.id());
    if (!atlas_.empty() && !block.empty())
      if (Status s = atlas_.draw(block); !s) return s;
    time = lap(time, times_.shadow_ms);
    for (int sample = 0; sample < options_.samples; ++sample) {
      const View view =
          make_view(camera, options_.width, options_.height, sample_offset(sample, options_.samples));
      // With one sample a pixel the G-buffer of the first block serves all blocks.
      if (first == 0 || options_.samples > 1) gbuffer_.draw(view);
      time = lap(time, times_.gbuffer_ms);
      shade(view, block, lights, first == 0, start_sum, environment_turn_rad);
      start_sum = false;
      time = lap(time, times_.shading_ms);
    }
  }
  if (glGetError() != GL_NO_ERROR)
    return Error{ErrorKind::failed, "the OpenGL ES driver failed (out of memory?)"};
  return {};
}

void Renderer::shade(const View& view, std::span<const LightRow> rows, const LightSet& lights,
                     bool first_block, bool start_sum, double environment_turn_rad) {
  const int earlier = current_;
  current_ = 1 - current_;
  glBindFramebuffer(GL_FRAMEBUFFER, sums_[current_].framebuffer.id());
  glViewport(0, 0, options_.width, options_.height);
  glDisable(GL_DEPTH_TEST);
  glUseProgram(program_.id());
  const auto integer = [&](const char* name, int value) { glUniform1i(gl::uniform(program_, name), value); };
  const auto real = [&](const char* name, float value) { glUniform1f(gl::uniform(program_, name), value); };
  const auto vector = [&](const char* name, const float* value) {
    glUniform3fv(gl::uniform(program_, name), 1, value);
  };
  const struct {
    const char* name;
    GLuint texture;
  } maps[] = {
      {"shadow_maps", atlas_.texture()},       {"position_material_map", gbuffer_.position_material()},
      {"surface_map", gbuffer_.surface()},     {"materials", gbuffer_.materials()},
      {"so_far", sums_[earlier].texture.id()}, {"environment", environment_.id()}};
  for (int unit = 0; unit < 6; ++unit) {
    gl::bind_texture(unit, maps[unit].texture);
    integer(maps[unit].name, unit);
  }
  integer("light_count", static_cast<int>(rows.size()));
  integer("tiles", atlas_.tiles());
  real("map_size", static_cast<float>(atlas_.map_size()));
  integer("has_shadows", atlas_.empty() ? 0 : 1);
  real("weight", 1 / static_cast<float>(options_.samples));
  integer("first_block", first_block ? 1 : 0);
  integer("start_sum", start_sum ? 1 : 0);
  integer("show_environment", show_environment_ ? 1 : 0);
  real("environment_turns", static_cast<float>(std::remainder(environment_turn_rad / (2 * kPi), 1.0)));
  vector("ambient", lights.ambient.data());
  vector("eye", view.eye.data());
  vector("view_forward", view.forward.data());
  vector("view_right", view.right.data());
  vector("view_up", view.up.data());
  glBindVertexArray(no_vertices_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void Renderer::tone_map(ToneMap operation, double dt_s) {
  const double start = now_ms();
  tone_mapper_.adapt(sums_[current_].texture.id(), operation, dt_s);
  tone_mapper_.draw(sums_[current_].texture.id());
  lap(start, times_.tonemap_ms);
}

RadiancePicture Renderer::radiance() const {
  const int width = options_.width;
  const int height = options_.height;
  RadiancePicture picture{width, height, std::vector<float>(static_cast<std::size_t>(width * height) * 4)};
  glBindFramebuffer(GL_FRAMEBUFFER, sums_[current_].framebuffer.id());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGBA, GL_FLOAT, picture.rgba.data());
  const auto row = static_cast<std::ptrdiff_t>(width) * 4;
  for (std::ptrdiff_t y = 0; y < height / 2; ++y)
    std::swap_ranges(picture.rgba.begin() + y * row, picture.rgba.begin() + (y + 1) * row,
                     picture.rgba.begin() + (height - 1 - y) * row);
  return picture;
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
