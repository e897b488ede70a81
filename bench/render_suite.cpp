// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/render_suite.h"

#include <ctime>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>

#include "bench/forward_renderer.h"
#include "bench/pictures/ray_tracer.h"
#include "interface/environment_io.h"
#include "lighting/decomposition/best_lights.h"
#include "lighting/decomposition/decompose.h"
#include "render/egl_context.h"

namespace lightwell::bench {
namespace {

using pictures::JudgedPicture;

constexpr int kDefaultLights = 72;
constexpr int kDefaultShadowSize = 256;

// The light as it is and turned by 40 degrees: a renderer that is given them in turn finds nothing of the frame before.
std::array<LightSet, 2> turning_lights(const LatLongImage& light, Method method, int count) {
  std::array<LightSet, 2> sets;
  for (std::size_t i = 0; i < 2; ++i) {
    const double turn_rad = i == 0 ? 0 : 40 * kPi / 180;
    if (auto set = decompose(polar_map_from_lat_long(light, true, turn_rad), method, count)) sets[i] = *set;
  }
  return sets;
}

render::RendererOptions judged_options(int shadow_size) {
  render::RendererOptions options;
  options.width = pictures::kPictureWidth;
  options.height = pictures::kPictureHeight;
  options.shadow_size = shadow_size;
  return options;
}

Row rendered_row(const JudgedPicture& judged, render::Renderer& renderer, Method method, int count,
                 const std::string& name, const Options& options) {
  const auto sets = turning_lights(judged.light, method, count);
  const render::SceneCamera& camera = judged.scene.cameras.at(0);
  Row row = timed_frames("picture, " + judged.name, name, options, [&](std::size_t i) {
    (void)renderer.render(sets[(i + 1) % 2], camera);
    renderer.finish();
  });
  (void)renderer.render(sets[0], camera);
  add_error(row, pictures::picture_error(pictures::colours_of(renderer.radiance()), judged.reference));
  row.values.emplace_back("lights", count);
  return row;
}

Row traced_row(const JudgedPicture& judged, const pictures::RayTracer& tracer, int count,
               const Options& options) {
  const auto sets = turning_lights(judged.light, Method::best, count);
  render::RadiancePicture picture;
  Row row = timed_frames("picture, " + judged.name, "Embree, best lights", options, [&](std::size_t i) {
    picture = tracer.picture(judged.scene.cameras.at(0), pictures::kPictureWidth, pictures::kPictureHeight,
                             sets[(i + 1) % 2].lights);
  });
  picture = tracer.picture(judged.scene.cameras.at(0), pictures::kPictureWidth, pictures::kPictureHeight,
                           sets[0].lights);
  add_error(row, pictures::picture_error(pictures::colours_of(picture), judged.reference));
  row.values.emplace_back("lights", count);
  return row;
}

// What making the lights of a frame costs where the light moves; the same for every picture but for its map.
Row lights_row(const JudgedPicture& judged, const Options& options) {
  std::array<PolarMap, 8> maps;
  for (std::size_t i = 0; i < maps.size(); ++i)
    maps[i] = polar_map_from_lat_long(judged.light, true, 0.01 * static_cast<double>(i));
  BestLights lights(maps[0].grid, kDefaultLights);
  return timed_frames("lights of a frame", judged.name, options, [&](std::size_t i) {
    // Forth and back, so that each differs from the one before by as much.
    const std::size_t step = i % (2 * maps.size() - 2);
    lights.process(maps[step < maps.size() ? step : 2 * maps.size() - 2 - step]);
  });
}

Row forward_row(const JudgedPicture& judged, const Options& options) {
  auto forward = ForwardRenderer::create(judged.scene, pictures::kPictureWidth, pictures::kPictureHeight,
                                         kDefaultShadowSize);
  if (!forward) {
    std::fprintf(stderr, "left out: %s\n", forward.error().message.c_str());
    return {};
  }
  const auto sets = turning_lights(judged.light, Method::best, kDefaultLights);
  const render::SceneCamera& camera = judged.scene.cameras.at(0);
  Row row = timed_frames("picture, " + judged.name, "forward, full meshes", options, [&](std::size_t i) {
    forward->render(sets[(i + 1) % 2], camera);
    glFinish();
  });
  forward->render(sets[0], camera);
  add_error(row, pictures::picture_error(pictures::colours_of(forward->radiance()), judged.reference));
  row.values.emplace_back("lights", kDefaultLights);
  return row;
}

// What is off by default, and what is on, at the default number of lights.
std::vector<Row> variant_rows(const JudgedPicture& judged, const Options& options) {
  std::vector<std::pair<std::string, render::RendererOptions>> variants(
      4, {"", judged_options(kDefaultShadowSize)});
  variants[0].first = "best, soft edges";
  variants[0].second.soft_edges = true;
  variants[1].first = "best, interleave 1";
  variants[1].second.interleave = 1;
  variants[2].first = "best, interleave 4";
  variants[2].second.interleave = 4;
  variants[3].first = "best, light lists";
  variants[3].second.light_lists = true;
  std::vector<Row> rows;
  for (const auto& [name, variant] : variants)
    if (auto renderer = renderer_of(judged.scene, variant))
      rows.push_back(rendered_row(judged, *renderer, Method::best, kDefaultLights, name, options));
  return rows;
}

// A light that turns by a twentieth of a degree a frame, as the sun does in twelve seconds; to a degree and back.
constexpr std::size_t kSlowCycle = 40;
LightSet slow_light(const LightSet& start, std::size_t frame) {
  LightSet set = start;
  const double step = std::abs(static_cast<double>(frame % kSlowCycle) - kSlowCycle / 2.0);
  const Eigen::AngleAxisf turn(static_cast<float>(step * 0.05 * kPi / 180), Vec3f::UnitY());
  for (DirectionalLight& light : set.lights) light.direction = turn * light.direction;
  return set;
}

Row slow_row(const JudgedPicture& judged, render::Renderer& renderer, const Options& options) {
  const LightSet start = turning_lights(judged.light, Method::best, kDefaultLights)[0];
  return timed_frames("slow light, " + judged.name, "best, maps of 256", options, [&](std::size_t i) {
    (void)renderer.render(slow_light(start, i), judged.scene.cameras.at(0));
    renderer.finish();
  });
}

// The pass that gives lights their maps: where every map is drawn, and where the light is slow. A whole number of its
// cycles, once the first has been drawn.
std::vector<Row> shadow_pass_rows(const JudgedPicture& judged) {
  render::RendererOptions measured = judged_options(kDefaultShadowSize);
  measured.measure_passes = true;
  auto renderer = renderer_of(judged.scene, measured);
  if (!renderer) return {};
  const auto turning = turning_lights(judged.light, Method::best, kDefaultLights);
  const auto row = [&](const std::string& name, const std::function<LightSet(std::size_t)>& lights) {
    constexpr std::size_t kFrames = 2 * kSlowCycle;
    std::vector<double> shadow_ms;
    double drawn = 0;
    for (std::size_t i = 0; i <= kFrames; ++i) {
      (void)renderer->render(lights(i), judged.scene.cameras.at(0));
      if (i == 0) continue;  // draws all
      shadow_ms.push_back(renderer->pass_times().shadow_ms);
      drawn += static_cast<double>(renderer->shadow_maps_drawn());
    }
    const double mean = std::accumulate(shadow_ms.begin(), shadow_ms.end(), 0.0) / kFrames;
    return Row{"maps, " + judged.name,
               name,
               timing_of(shadow_ms),
               {{"maps_drawn_a_frame", drawn / kFrames}, {"shadow_pass_mean_ms", mean}}};
  };
  return {row("every map", [&](std::size_t i) { return turning[(i + 1) % 2]; }),
          row("slow light", [&](std::size_t i) { return slow_light(turning[0], i); })};
}

std::vector<Row> picture_rows(const JudgedPicture& judged, const Options& options, bool all) {
  std::vector<Row> rows;
  const auto tracer = pictures::RayTracer::create(judged.scene);
  if (!tracer) return rows;
  const std::vector<int> counts =
      all ? std::vector<int>{8, 16, 32, 72, 128, 256, 512, 1024} : std::vector<int>{kDefaultLights};
  for (const int size : {256, 512, 1024}) {
    auto renderer = renderer_of(judged.scene, size);
    if (!renderer) continue;
    for (const Method method : {Method::best, Method::havran})
      for (const int count : counts) {
        if ((method != Method::best || count != kDefaultLights) && size != kDefaultShadowSize) continue;
        if (method != Method::best && !all) continue;
        rows.push_back(rendered_row(
            judged, *renderer, method, count,
            std::string(lightwell::name(method)) + ", maps of " + std::to_string(size), options));
      }
    if (size == kDefaultShadowSize && all) rows.push_back(slow_row(judged, *renderer, options));
  }
  for (const int count : counts) rows.push_back(traced_row(judged, *tracer, count, options));
  if (all) {
    rows.push_back(forward_row(judged, options));
    for (Row& row : variant_rows(judged, options)) rows.push_back(std::move(row));
    for (Row& row : shadow_pass_rows(judged)) rows.push_back(std::move(row));
    rows.push_back(lights_row(judged, options));
  }
  return rows;
}

// The judged scenes under real light of their kind, where there is any.
std::vector<JudgedPicture> under_real_light(const Options& options) {
  std::vector<JudgedPicture> all;
  if (options.data_folder.empty()) return all;
  const std::array<std::pair<std::string_view, const char*>, 4> files = {
      {{"poles", "kloppenheim_05_1k.hdr"},
       {"figure", "moonless_golf_1k.hdr"},
       {"phong", "st_fagans_interior_1k.hdr"},
       {"box", "potsdamer_platz_1k.hdr"}}};
  for (const auto& [name, file] : files) {
    auto image = read_environment(std::filesystem::path(options.data_folder) / "env" / file);
    if (!image) continue;
    for (const pictures::JudgedScene& scene : pictures::judged_scenes()) {
      if (scene.name != name || scene.name.find(options.only_setting) == std::string_view::npos) continue;
      auto judged = pictures::judged_picture(scene, std::move(image->image));
      if (!judged) continue;
      judged->name += ", " + std::filesystem::path(file).stem().string();
      all.push_back(std::move(judged).value());
    }
  }
  return all;
}

const Row* row_named(const std::vector<Row>& rows, const std::string& setting, const std::string& name,
                     int lights = 0) {
  for (const Row& row : rows)
    if (row.setting == setting && row.name == name && (lights == 0 || value_of(row, "lights") == lights))
      return &row;
  return nullptr;
}

// Processor time that the peer needs for an error, by straight lines through its logarithms, on beyond its ends.
double cpu_ms_at(const std::vector<Row>& rows, const std::string& setting, const std::string& peer,
                 double error) {
  std::vector<std::pair<double, double>> points;  // log error, log time
  for (const Row& row : rows)
    if (row.setting == setting && row.name == peer)
      points.emplace_back(std::log(value_of(row, "relative_rmse")), std::log(value_of(row, "cpu_ms")));
  if (points.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  std::sort(points.rbegin(), points.rend());
  std::size_t i = 1;
  while (i + 1 < points.size() && points[i].first > std::log(error)) ++i;
  const auto& [x0, y0] = points[i - 1];
  const auto& [x1, y1] = points[i];
  return std::exp(y0 + (std::log(error) - x0) / (x1 - x0) * (y1 - y0));
}

// What the renderer is asked to reach, as ratios.
void add_comparisons(std::vector<Row>& rows, const std::vector<JudgedPicture>& judged) {
  for (const JudgedPicture& picture : judged) {
    const std::string setting = "picture, " + picture.name;
    const Row* ours = row_named(rows, setting, "best, maps of 256", kDefaultLights);
    const Row* exact = row_named(rows, setting, "Embree, best lights", kDefaultLights);
    if (ours == nullptr || exact == nullptr) continue;
    Row row{"compared", picture.name, ours->timing, {}};
    const double cpu_ms = value_of(*ours, "cpu_ms");
    const double error = value_of(*ours, "relative_rmse");
    row.values.emplace_back("added_by_shadow_maps", error / value_of(*exact, "relative_rmse") - 1);
    if (const Row* forward = row_named(rows, setting, "forward, full meshes"))
      row.values.emplace_back("forward_over_ours_cpu", value_of(*forward, "cpu_ms") / cpu_ms);
    if (const Row* slow = row_named(rows, "slow light, " + picture.name, "best, maps of 256"))
      row.values.emplace_back("every_tile_over_slow_light_cpu", cpu_ms / value_of(*slow, "cpu_ms"));
    const Row* every_map = row_named(rows, "maps, " + picture.name, "every map");
    const Row* slow_maps = row_named(rows, "maps, " + picture.name, "slow light");
    if (every_map != nullptr && slow_maps != nullptr)
      row.values.emplace_back(
          "every_tile_over_slow_light_shadow_pass",
          value_of(*every_map, "shadow_pass_mean_ms") / value_of(*slow_maps, "shadow_pass_mean_ms"));
    const Row* lights = row_named(rows, "lights of a frame", picture.name);
    const double mitsuba = cpu_ms_at(rows, setting, "Mitsuba", error);
    if (lights != nullptr && std::isfinite(mitsuba))
      row.values.emplace_back("mitsuba_over_ours_cpu_at_equal_error",
                              mitsuba / (cpu_ms + value_of(*lights, "cpu_ms")));
    rows.push_back(std::move(row));
  }
}

}  // namespace

double process_cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

Row timed_frames(const std::string& setting, const std::string& name, const Options& options,
                 const std::function<void(std::size_t)>& frame) {
  using Clock = std::chrono::steady_clock;
  const auto ms_since = [](Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  };
  constexpr std::size_t kLeastRuns = 3;
  std::vector<double> wall, cpu;
  frame(0);
  const auto start = Clock::now();
  for (std::size_t i = 1; wall.size() < kLeastRuns || ms_since(start) < 1000 * options.seconds_per_case;
       ++i) {
    const double cpu_start = process_cpu_ms();
    const auto begin = Clock::now();
    frame(i);
    wall.push_back(ms_since(begin));
    cpu.push_back(process_cpu_ms() - cpu_start);
  }
  return {setting, name, timing_of(wall), {{"cpu_ms", timing_of(cpu).p50_ms}}};
}

void add_error(Row& row, const pictures::PictureError& error) {
  row.values.emplace_back("relative_rmse", error.relative_rmse);
  row.values.emplace_back("flip", error.flip);
  row.values.emplace_back("bias", error.bias);
}

double value_of(const Row& row, const std::string& name) {
  for (const auto& [key, value] : row.values)
    if (key == name) return value;
  return std::numeric_limits<double>::quiet_NaN();
}

std::optional<render::Renderer> renderer_of(const render::Scene& scene, int shadow_size, int width,
                                            int height) {
  render::RendererOptions options;
  options.width = width;
  options.height = height;
  options.shadow_size = shadow_size;
  return renderer_of(scene, options);
}

std::optional<render::Renderer> renderer_of(const render::Scene& scene,
                                            const render::RendererOptions& options) {
  auto renderer = render::Renderer::create(scene, options);
  if (renderer) return std::move(renderer).value();
  std::fprintf(stderr, "left out: %s\n", renderer.error().message.c_str());
  return std::nullopt;
}

std::vector<Row> render_suite(const Options& options) {
  const auto context = render::EglContext::create();
  if (!context) {
    std::fprintf(stderr, "left out: %s\n", context.error().message.c_str());
    return {};
  }
  std::vector<JudgedPicture> judged;
  const auto asked = [&](std::string_view name) {
    return name.find(options.only_setting) != std::string_view::npos;
  };
  for (const pictures::JudgedScene& scene : pictures::judged_scenes()) {
    if (!asked(scene.name)) continue;
    auto picture = pictures::judged_picture(scene, options.references_folder);
    if (picture)
      judged.push_back(std::move(picture).value());
    else
      std::fprintf(stderr, "left out: %s\n", picture.error().message.c_str());
  }
  std::vector<Row> rows;
  const auto take = [&](std::vector<Row> more) {
    std::move(more.begin(), more.end(), std::back_inserter(rows));
  };
  for (const JudgedPicture& picture : judged) take(picture_rows(picture, options, true));
  for (const JudgedPicture& picture : under_real_light(options)) take(picture_rows(picture, options, false));
  take(mitsuba_rows(judged, options));
  add_comparisons(rows, judged);
  if (asked("growth")) take(render_growth_rows(options));
  if (asked("gloss")) take(render_gloss_rows());
  if (asked("field light")) take(render_field_rows(options));
  if (asked("lamp")) take(render_lamp_rows(options));
  if (asked("steadiness")) take(render_steadiness_rows(options));
  return rows;
}

}  // namespace lightwell::bench
