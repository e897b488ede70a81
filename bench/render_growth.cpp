// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cstdio>

#include "bench/pictures/judged_lights.h"
#include "bench/render_suite.h"
#include "lighting/decomposition/decompose.h"

namespace lightwell::bench {
namespace {

// Lights in turn, so that every map is drawn anew.
struct Growth {
  std::string setting;
  std::string variable;
  const Options& options;
  std::array<LightSet, 2> lights;

  Row row(render::Renderer& renderer, const render::Scene& scene, double value) const {
    Row row = timed_frames(setting, "best, maps of 256", options, [&](std::size_t i) {
      (void)renderer.render(lights[i % 2], scene.cameras.at(0));
      renderer.finish();
    });
    row.values.emplace_back(variable, value);
    return row;
  }
};

std::array<LightSet, 2> sun_lights(int count) {
  static const LatLongImage image = pictures::sun_light();
  return {*decompose(polar_map_from_lat_long(image, true), Method::best, count),
          *decompose(polar_map_from_lat_long(image, true, 0.7), Method::best, count)};
}

double ms_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

std::vector<Row> render_growth_rows(const Options& options) {
  constexpr int kLights = 72;
  std::vector<Row> rows;
  const render::Scene scene = pictures::balls_scene(16000);
  if (auto renderer = renderer_of(scene, 256))
    for (const int count : {8, 16, 32, 64, 128, 256, 512, 1024})
      rows.push_back(
          Growth{"growth, lights", "lights", options, sun_lights(count)}.row(*renderer, scene, count));
  const Growth pixels{"growth, pixels", "pixels", options, sun_lights(kLights)};
  for (const auto& [width, height] : {std::pair(320, 240), std::pair(640, 480), std::pair(1280, 720),
                                      std::pair(1920, 1080), std::pair(3840, 2160)})
    if (auto renderer = renderer_of(scene, 256, width, height))
      rows.push_back(pixels.row(*renderer, scene, static_cast<double>(width) * height));
  const Growth triangles{"growth, triangles", "triangles", options, pixels.lights};
  constexpr double kMostSetup_ms = 120'000;  // preparing grows with the triangles
  double expected_ms = 0;
  for (const int count : {10'000, 100'000, 1'000'000, 10'000'000}) {
    if (expected_ms > kMostSetup_ms) {
      std::fprintf(stderr, "left out: %d triangles, to prepare them would take %.0f s\n", count,
                   expected_ms / 1000);
      continue;
    }
    const render::Scene balls = pictures::balls_scene(count);
    const auto start = std::chrono::steady_clock::now();
    auto renderer = renderer_of(balls, 256);
    const double setup_ms = ms_since(start);
    expected_ms = 10 * setup_ms;
    if (!renderer) continue;
    rows.push_back(triangles.row(*renderer, balls, static_cast<double>(balls.triangles())));
    rows.back().values.emplace_back("setup_ms", setup_ms);
  }
  return rows;
}

}  // namespace lightwell::bench
