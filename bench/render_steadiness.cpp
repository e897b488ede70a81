// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "bench/pictures/ray_tracer.h"
#include "bench/render_suite.h"
#include "daemon/simulator/scene.h"
#include "lighting/decomposition/best_lights.h"

namespace lightwell::bench {
namespace {

constexpr int kWidth = 48;  // times 36 times a map's bins: 220 MB of visibility
constexpr int kHeight = 36;
constexpr int kLights = 72;
constexpr int kFrames = 75;
constexpr double kRate_hz = 25;

// The light of the simulated camera's scenarios, as maps of 90 × 360.
class ScenarioMaps {
 public:
  explicit ScenarioMaps(const std::string& name) : scene_(simulator::make_scenario(name).value()) {}

  PolarMap frame(int index) {
    const double begin_s = index / kRate_hz;
    const simulator::SceneMoment moment = scene_->at(begin_s, begin_s + scene_->default_exposure_us() * 1e-6);
    PolarMap map = PolarMap::make(grid_, 3);
    for (const auto& part : moment.parts) {
      const PolarMap& layer = layer_map(part.layer);
      for (std::size_t i = 0; i < map.radiance.size(); ++i)
        map.radiance[i] += static_cast<float>(part.weight) * layer.radiance[i];
    }
    for (const simulator::DiscLight& light : moment.lights) add(light, map);
    return map;
  }

 private:
  const PolarMap& layer_map(std::int64_t id) {
    auto known = layers_.find(id);
    if (known == layers_.end())
      known =
          layers_.emplace(id, resample_polar(polar_map_from_lat_long(scene_->layer(id).image, true), grid_))
              .first;
    return known->second;
  }
  void add(const simulator::DiscLight& light, PolarMap& map) const {
    constexpr int kSamples = 256;
    for (const Vec3d& direction : simulator::disc_samples(light, kSamples)) {
      const Spherical s = spherical_from_direction(direction);
      if (s.theta_rad >= grid_.theta_max_rad) continue;
      const int ring = static_cast<int>(s.theta_rad / grid_.theta_max_rad * grid_.rings);
      const int sector =
          std::min(static_cast<int>(s.lambda_rad / (2 * kPi) * grid_.sectors), grid_.sectors - 1);
      const std::size_t bin = static_cast<std::size_t>(ring) * static_cast<std::size_t>(grid_.sectors) +
                              static_cast<std::size_t>(sector);
      for (int c = 0; c < 3; ++c)
        map.plane(c)[bin] +=
            static_cast<float>(light.illuminance[c] / kSamples / grid_.bin_solid_angle_sr(ring));
    }
  }

  PolarGrid grid_;
  std::shared_ptr<const simulator::Scene> scene_;
  std::map<std::int64_t, PolarMap> layers_;
};

// The exact picture of any light, pixel by pixel a sum over the map's bins: luminance.
class LightTransport {
 public:
  LightTransport(const pictures::RayTracer& tracer, const render::SceneCamera& camera, const PolarGrid& grid)
      : visible_(tracer.transport(camera, kWidth, kHeight, lights_of(grid))), bins_(grid.size()) {}

  [[nodiscard]] std::vector<double> picture(const PolarMap& map) const {
    std::vector<float> light(bins_);
    for (std::size_t bin = 0; bin < bins_; ++bin)
      light[bin] = luminance(map.rgb(bin)) * map.solid_angle_sr[bin];
    std::vector<double> out;
    for (std::size_t pixel = 0; pixel < visible_.size() / bins_; ++pixel) {
      double sum = 0;
      for (std::size_t bin = 0; bin < bins_; ++bin)
        sum += static_cast<double>(visible_[pixel * bins_ + bin] * light[bin]);
      out.push_back(sum);
    }
    return out;
  }

 private:
  static std::vector<DirectionalLight> lights_of(const PolarGrid& grid) {
    std::vector<DirectionalLight> lights;
    for (int ring = 0; ring < grid.rings; ++ring)
      for (int sector = 0; sector < grid.sectors; ++sector)
        lights.push_back({grid.bin_direction(ring, sector).cast<float>(), Rgb::Ones(), -1, 0});
    return lights;
  }

  std::vector<float> visible_;  // [pixel][bin]: luminance a lux from there returns
  std::size_t bins_;
};

Row steadiness_row(const std::string& scenario, const std::string& name, const render::Scene& scene,
                   const LightTransport& transport, bool soft_edges, const Options& options) {
  render::RendererOptions of_renderer;
  of_renderer.width = kWidth;
  of_renderer.height = kHeight;
  of_renderer.soft_edges = soft_edges;
  auto renderer = renderer_of(scene, of_renderer);
  if (!renderer) return {};
  ScenarioMaps maps(scenario);
  BestLights lights(PolarGrid(), kLights, Effort::thorough);
  std::vector<double> before, reference_before;
  double excess = 0, reference_change = 0, total = 0, error = 0, reference_squares = 0;
  const int frames = options.seconds_per_case > 0 ? kFrames : 3;
  for (int frame = 0; frame < frames; ++frame) {
    const PolarMap map = maps.frame(frame);
    const auto chosen = lights.process(map);
    LightSet set;
    set.lights.assign(chosen.begin(), chosen.end());
    set.has_parents = true;
    (void)renderer->render(set, scene.cameras.at(0));
    const render::RadiancePicture picture = renderer->radiance();
    const std::vector<double> reference = transport.picture(map);
    std::vector<double> now;
    for (const Rgb& colour : pictures::colours_of(picture))
      now.push_back(static_cast<double>(luminance(colour)));
    for (std::size_t i = 0; i < now.size(); ++i) {
      total += reference[i];
      error += std::pow(now[i] - reference[i], 2);
      reference_squares += std::pow(reference[i], 2);
      if (before.empty()) continue;
      const double own = std::abs(reference[i] - reference_before[i]);
      reference_change += own;
      excess += std::max(0.0, std::abs(now[i] - before[i]) - own);
    }
    before = std::move(now);
    reference_before = reference;
  }
  const double mean_frame = total / frames * (frames - 1);
  constexpr double kNotTimed = std::numeric_limits<double>::quiet_NaN();
  Row row{"steadiness", scenario + ", " + name, {kNotTimed, kNotTimed, kNotTimed, 0}, {}};
  row.values = {{"excess_change", excess / mean_frame},
                {"reference_change", reference_change / mean_frame},
                {"relative_rmse", std::sqrt(error / reference_squares)},
                {"lights", kLights}};
  return row;
}

}  // namespace

std::vector<Row> render_steadiness_rows(const Options& options) {
  std::vector<Row> rows;
  for (const pictures::JudgedScene& scene : pictures::judged_scenes()) {
    if (scene.name != "poles" && scene.name != "phong") continue;  // matte beside thin things, and gloss
    const auto shown = pictures::read_judged(scene);
    if (!shown) continue;
    const auto tracer = pictures::RayTracer::create(*shown);
    if (!tracer) continue;
    const LightTransport transport(*tracer, shown->cameras.at(0), PolarGrid());
    for (const char* scenario : {"flicker", "day"})
      for (const bool soft : {false, true})
        rows.push_back(steadiness_row(scenario, std::string(scene.name) + (soft ? ", soft edges" : ""),
                                      *shown, transport, soft, options));
  }
  return rows;
}

}  // namespace lightwell::bench
