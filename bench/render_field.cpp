// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// What it costs that light differs from place to place: frames of 1024 × 768 under a field of 64³ points, and by the same
// program under harmonics that are the same everywhere.
#include <array>
#include <chrono>
#include <memory>

#include "bench/render_suite.h"
#include "render/field_shading.h"
#include "render/tone_mapper.h"

namespace lightwell::bench {
namespace {

constexpr int kWidth = 1024, kHeight = 768, kDegree = 4;
constexpr int kConstantTexels = 19;  // of four numbers: 75

// Two lamps whose light falls off over the scene.
LightField field_over(const render::Sphere& scene) {
  LightField field;
  const Vec3d centre = scene.centre.cast<double>(),
              reach = Vec3d::Constant(static_cast<double>(scene.radius));
  field.grid = {{64, 64, 64}, centre - reach, centre + reach};
  field.degree = kDegree;
  field.radiance.resize(field.grid.points() * 75);
  std::array<double, 25> high{}, low{};
  harmonics(Vec3d(0.5, 0.8, 0.3).normalized(), kDegree, high.data());
  harmonics(Vec3d(-0.7, 0.2, 0.6).normalized(), kDegree, low.data());
  for (int k = 0; k < 64; ++k)
    for (std::size_t h = 0; h < 25; ++h)
      for (int c = 0; c < 3; ++c) {
        float* plane = field.plane(k, static_cast<int>(h), c);
        for (int i = 0; i < 64 * 64; ++i)
          plane[i] = static_cast<float>(high[h] * (i % 64) + low[h] * (64 - i / 64) + (h == 0 ? 20 : 0));
      }
  return field;
}

// A frame: the G-buffer, what lights it, and tone mapping.
struct Pipeline {
  render::GBuffer gbuffer;
  render::Casters casters;
  render::ShadowAtlas no_maps;
  render::FieldShading shading;
  render::gl::Texture sum, nothing;
  render::gl::Framebuffer target;
  render::ToneMapper tone_mapper;

  static Result<std::unique_ptr<Pipeline>> create(const render::Scene& scene, const LightField& field,
                                                  const std::string& facts) {
    auto p = std::make_unique<Pipeline>();
    p->casters = render::find_casters(scene);
    auto gbuffer = render::GBuffer::create(scene, p->casters);
    if (!gbuffer) return gbuffer.error();
    p->gbuffer = std::move(gbuffer).value();
    if (Status s = p->gbuffer.resize(kWidth, kHeight); !s) return s.error();
    p->shading = render::FieldShading::create(render::material_kinds(scene), true, {}, facts);
    if (Status s = p->shading.set(field, {}); !s) return s.error();
    p->shading.set_lights({}, 0);
    p->sum = render::gl::make_texture(GL_RGBA32F, kWidth, kHeight);
    p->nothing = render::gl::make_texture(GL_RGBA32F, 1, 1);
    auto target = render::gl::make_framebuffer({p->sum.id()}, p->gbuffer.depth());
    if (!target) return target.error();
    p->target = std::move(target).value();
    auto tone_mapper = render::ToneMapper::create();
    if (!tone_mapper) return tone_mapper.error();
    p->tone_mapper = std::move(tone_mapper).value();
    if (Status s = p->tone_mapper.resize(kWidth, kHeight); !s) return s.error();
    return p;
  }

  // Some light for the side that has it the same everywhere: black would be tone-mapped another way. Right after shading, whose
  // program is in use.
  static void set_constant_light() {
    GLint program = 0;
    glGetIntegerv(GL_CURRENT_PROGRAM, &program);
    std::array<float, 4 * kConstantTexels> texels;
    for (std::size_t i = 0; i < texels.size(); ++i) texels[i] = i < 4 ? 60.0f : 2.0f;  // the mean first
    glUniform4fv(glGetUniformLocation(static_cast<GLuint>(program), "constant_texels"), kConstantTexels,
                 texels.data());
  }

  bool lit = false;  // set_constant_light() was called

  // Returns when shading had ended.
  std::chrono::steady_clock::time_point draw(const render::SceneCamera& camera) {
    const render::View view = make_view(camera, kWidth, kHeight);
    glDepthFunc(GL_LESS);  // shading leaves another
    gbuffer.draw(view);
    shading.shade(true, {view, Rgb::Zero(), true, true, 1},
                  {target.id(), nothing.id(), true, kWidth, kHeight}, gbuffer, no_maps, casters);
    if (!lit) set_constant_light();
    lit = true;
    glFinish();
    const auto shaded = std::chrono::steady_clock::now();
    tone_mapper.adapt(sum.id(), 0.04);
    tone_mapper.draw(sum.id());
    glFinish();
    return shaded;
  }
};

}  // namespace

std::vector<Row> render_field_rows(const Options& options) {
  std::vector<Row> rows;
  for (const pictures::JudgedScene& judged : pictures::judged_scenes()) {
    if (judged.name != "phong") continue;
    auto scene = pictures::read_judged(judged);
    if (!scene) continue;
    for (const bool glossy : {true, false}) {
      if (!glossy)
        for (render::Material& m : scene->materials) m.specular = Rgb::Zero();
      const LightField field = field_over(render::find_casters(*scene).scene);
      const std::string setting = glossy ? "field light, glossy" : "field light, matt";
      auto of_field = Pipeline::create(*scene, field, "");
      auto constant = Pipeline::create(*scene, field,
                                       "uniform highp vec4 constant_texels[19];\n"
                                       "#define FIELD_TEXEL(number, map, corner) constant_texels[number]\n");
      if (!of_field || !constant) continue;
      const render::SceneCamera& camera = scene->cameras.at(0);
      // In turns, so that a busy machine slows both.
      std::vector<double> field_ms, constant_ms, field_shaded_ms, constant_shaded_ms;
      const auto begin = std::chrono::steady_clock::now();
      using Clock = std::chrono::steady_clock;
      const auto ms = [](Clock::duration time) {
        return std::chrono::duration<double, std::milli>(time).count();
      };
      constexpr std::size_t kLeastFrames = 20;
      for (std::size_t i = 0; i <= kLeastFrames || ms(Clock::now() - begin) < 2000 * options.seconds_per_case;
           ++i) {
        const auto first = Clock::now();
        const auto field_shaded = (*of_field)->draw(camera);
        const auto second = Clock::now();
        const auto constant_shaded = (*constant)->draw(camera);
        const auto end = Clock::now();
        if (i == 0) continue;  // warms up
        field_ms.push_back(ms(second - first));
        constant_ms.push_back(ms(end - second));
        field_shaded_ms.push_back(ms(field_shaded - first));
        constant_shaded_ms.push_back(ms(constant_shaded - second));
      }
      Row field_row{setting, "64 cubed, degree 4", timing_of(field_ms), {}};
      const Row constant_row{setting, "the same everywhere", timing_of(constant_ms), {}};
      field_row.values = {{"over_constant_p50", field_row.timing.p50_ms / constant_row.timing.p50_ms},
                          {"over_constant_p99", field_row.timing.p99_ms / constant_row.timing.p99_ms},
                          {"over_constant_before_tone_mapping_p50",
                           timing_of(field_shaded_ms).p50_ms / timing_of(constant_shaded_ms).p50_ms}};
      rows.push_back(field_row);
      rows.push_back(constant_row);
    }
  }
  return rows;
}

}  // namespace lightwell::bench
