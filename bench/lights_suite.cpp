// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/lights_suite.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "bench/row_column_inversion.h"
#include "lighting/decomposition/clustering.h"
#include "lighting/evaluation/evaluate.h"
#include "lighting/light_pipeline.h"
#include "lighting/sampling/halton.h"
#include "lighting/sampling/relaxation.h"
#include "lighting/sampling/ring_sampling.h"
#include "lighting/temporal/fir_design.h"
#include "lighting/temporal/light_filter.h"

namespace lightwell::bench {
namespace {

const PolarGrid kGrid{90, 360, kPi / 2};

void add_disc(PolarMap& map, double azimuth_deg, double zenith_deg, double radius_deg, const Rgb& radiance) {
  const Vec3d axis = direction_from_spherical({zenith_deg * kPi / 180, azimuth_deg * kPi / 180});
  for (int k = 0; k < kGrid.rings; ++k)
    for (int s = 0; s < kGrid.sectors; ++s) {
      if (kGrid.bin_direction(k, s).dot(axis) < std::cos(radius_deg * kPi / 180)) continue;
      const auto bin = static_cast<std::size_t>(k * kGrid.sectors + s);
      for (int c = 0; c < 3; ++c) map.plane(c)[bin] += radiance[c];
    }
}

// Blue sky that brightens toward the horizon, some texture, and a sun with most of the light.
PolarMap sunny(double azimuth_deg) {
  PolarMap map = PolarMap::make(kGrid, 3);
  for (int k = 0; k < kGrid.rings; ++k)
    for (int s = 0; s < kGrid.sectors; ++s) {
      const double cloud = 1 + 0.5 * std::sin(0.11 * s) * std::sin(0.23 * k + 0.05 * s);
      const auto value = static_cast<float>(2000 * cloud * (1 + std::pow(k / 89.0, 3)));
      const auto bin = static_cast<std::size_t>(k * kGrid.sectors + s);
      for (int c = 0; c < 3; ++c)
        map.plane(c)[bin] = value * std::array{0.6f, 0.9f, 1.6f}[static_cast<std::size_t>(c)];
    }
  add_disc(map, azimuth_deg, 48, 0.8, Rgb(9e7f, 8.5e7f, 7e7f));
  return map;
}

// A dim room with two windows and lamps of several colours.
PolarMap room() {
  PolarMap map = PolarMap::make(kGrid, 3);
  for (float& v : map.radiance) v = 3;
  for (int k = 45; k < 80; ++k)
    for (int s = 0; s < kGrid.sectors; ++s)
      if ((s > 20 && s < 60) || (s > 75 && s < 100))
        for (int c = 0; c < 3; ++c)
          map.plane(c)[static_cast<std::size_t>(k * kGrid.sectors + s)] =
              900 + 100.0f * static_cast<float>(c);
  add_disc(map, 200, 20, 3, Rgb(9000, 7000, 3000));
  add_disc(map, 260, 55, 2, Rgb(6000, 6000, 5500));
  add_disc(map, 310, 70, 4, Rgb(300, 300, 2500));
  return map;
}

struct Times {
  double p50_us, p99_us, max_us;
};

// prepare runs before each frame and is not counted.
Times measure(
    int frames, const std::function<void(int)>& work, const std::function<void(int)>& prepare = [](int) {}) {
  for (int i = 0; i < 20; ++i) {
    prepare(i);
    work(i);
  }
  std::vector<double> us;
  for (int i = 0; i < frames; ++i) {
    prepare(i);
    const auto start = std::chrono::steady_clock::now();
    work(i);
    us.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
  }
  std::sort(us.begin(), us.end());
  return {us[us.size() / 2], us[us.size() * 99 / 100], us.back()};
}

nlohmann::ordered_json stage(const std::string& name, const Times& t) {
  return {{"name", name}, {"p50_us", t.p50_us}, {"p99_us", t.p99_us}, {"max_us", t.max_us}};
}

nlohmann::ordered_json stages(int frames) {
  std::vector<PolarMap> maps;
  for (int i = 0; i < 8; ++i) maps.push_back(sunny(100 + i));
  // Each frame's map is written into the same place just before, as the radiometer does.
  PolarMap map = maps[0];
  const auto write = [&](int i) {
    const std::vector<float>& radiance = maps[static_cast<std::size_t>(i) % maps.size()].radiance;
    std::copy(radiance.begin(), radiance.end(), map.radiance.begin());
  };

  RingDistribution distribution(kGrid);
  AzimuthSeam seam(kGrid);
  const HavranTransform sampler(distribution, seam);
  std::vector<Vec2d> square = halton_points(300);
  relax_on_torus(square);
  const auto points = warp_points<HavranTransform>(square);
  LightArrays sampled(300), filtered(300);
  LightFilter filter(design_fir({60, 20, 25.714, 8}).value().taps, 300, kGrid.theta_max_rad);
  Clustering clustering(72, kGrid.theta_max_rad);
  auto pipeline = LightPipeline::create(kGrid, 3, {}).value();

  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  const auto sum = [&](int) {
    distribution.build(map);
    seam.follow(distribution);
  };
  list.push_back(stage("cumulative sums and seam", measure(frames, sum, write)));
  list.push_back(stage("sample 300", measure(
                                         frames, [&](int) { sample_lights(sampler, map, points, sampled); },
                                         [&](int i) {
                                           write(i);
                                           sum(i);
                                         })));
  list.push_back(stage("filter 300", measure(frames, [&](int) { filter.apply(sampled, filtered); })));
  list.push_back(stage("cluster 300 to 72", measure(frames, [&](int) { clustering.apply(filtered); })));
  list.push_back(stage("map to 300 lights, filtered, clustered",
                       measure(
                           frames, [&](int) { static_cast<void>(pipeline.process(map)); }, write)));
  return list;
}

// One method on one map: how to draw the lights, over and over, and the lights drawn.
struct Drawing {
  std::function<void()> draw;
  std::function<std::vector<DirectionalLight>()> lights;
};

template <class Sampler>
Drawing of_sampler(const Sampler& sampler, const PolarMap& map, const std::vector<Vec2d>& square) {
  const auto points = std::make_shared<std::vector<RingCoordinates>>(warp_points<Sampler>(square));
  const auto lights = std::make_shared<LightArrays>(square.size());
  const auto draw = [sampler, &map, points, lights] { sample_lights(sampler, map, *points, *lights); };
  return {draw, [draw, lights] {
            draw();
            std::vector<DirectionalLight> list(lights->size());
            for (std::size_t i = 0; i < list.size(); ++i) {
              list[i].direction = {lights->x[i], lights->y[i], lights->z[i]};
              list[i].illuminance = {lights->r[i], lights->g[i], lights->b[i]};
            }
            return list;
          }};
}

Drawing of_row_column(const RowColumnInversion& peer, const PolarMap& map, const std::vector<Vec2d>& square) {
  const auto list = std::make_shared<std::vector<DirectionalLight>>(square.size());
  const auto draw = [&peer, &map, square, list] {
    for (std::size_t i = 0; i < square.size(); ++i) (*list)[i] = peer.sample(map, square[i], square.size());
  };
  return {draw, [draw, list] {
            draw();
            return *list;
          }};
}

std::vector<Vec2d> random_points(std::size_t count) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Vec2d> points(count);
  for (Vec2d& p : points) p = {uniform(random), uniform(random)};
  return points;
}

nlohmann::ordered_json sampling(int frames) {
  const std::vector<PolarMap> maps = {sunny(100), room()};
  const std::vector<std::string> methods = {"havran", "standard", "printed", "row_column", "random"};
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const std::size_t count : {std::size_t{64}, std::size_t{300}, std::size_t{1024}}) {
    const std::vector<Vec2d> halton = halton_points(count);
    const std::vector<Vec2d> random = random_points(count);
    std::vector<Vec2d> relaxed = halton;
    relax_on_torus(relaxed);
    for (const std::string& method : methods) {
      Times times{};
      LightError error;
      for (const PolarMap& map : maps) {
        RingDistribution distribution(kGrid);
        AzimuthSeam seam(kGrid);
        distribution.build(map);
        if (method == "printed")
          seam.fix(distribution, 0);
        else
          seam.follow(distribution);
        RowColumnInversion peer(kGrid);
        peer.build(map);
        Drawing drawing;
        if (method == "havran")
          drawing = of_sampler(HavranTransform(distribution, seam), map, relaxed);
        else if (method == "standard")
          drawing = of_sampler(StandardInversion(distribution, seam), map, halton);
        else if (method == "printed")
          drawing = of_sampler(HavranTransform(distribution, seam, HavranTransform::Interpolation::printed),
                               map, halton);
        else
          drawing = of_row_column(peer, map, method == "random" ? random : halton);
        const Times t = measure(frames, [&](int) { drawing.draw(); });
        LightSet set;
        set.lights = drawing.lights();
        const LightError e = LightEvaluator(map).error(set);
        const auto share = 1 / static_cast<double>(maps.size());
        times.p50_us += t.p50_us * share;
        times.p99_us += t.p99_us * share;
        error.irradiance_rel_rmse += e.irradiance_rel_rmse * share;
        error.shadow_rel_rmse += e.shadow_rel_rmse * share;
      }
      list.push_back({{"method", method},
                      {"lights", count},
                      {"p50_us", times.p50_us},
                      {"p99_us", times.p99_us},
                      {"lights_per_ms", 1000 * static_cast<double>(count) / times.p50_us},
                      {"irradiance_rel_rmse", error.irradiance_rel_rmse},
                      {"shadow_rel_rmse", error.shadow_rel_rmse}});
    }
  }
  return list;
}

}  // namespace

nlohmann::ordered_json lights_suite(int frames) {
  return {{"stages", stages(frames)}, {"sampling", sampling(frames)}};
}

}  // namespace lightwell::bench
