// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/light_pipeline.h"

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "lighting/decomposition/best_lights.h"
#include "lighting/decomposition/clustering.h"
#include "lighting/sampling/azimuth_seam.h"
#include "lighting/sampling/halton.h"
#include "lighting/sampling/light_arrays.h"
#include "lighting/sampling/relaxation.h"
#include "lighting/sampling/ring_distribution.h"
#include "lighting/sampling/ring_sampling.h"
#include "lighting/temporal/fir_design.h"
#include "lighting/temporal/light_filter.h"

namespace lightwell {
namespace {

constexpr int kMostLights = 100000;

Error out_of_range(const char* name, double value, const std::string& range) {
  return {ErrorKind::usage, std::string(name) + " " + std::to_string(value) + " is out of range: " + range};
}

Error out_of_range(const char* name, int value, const std::string& range) {
  return {ErrorKind::usage, std::string(name) + " " + std::to_string(value) + " is out of range: " + range};
}

Status check(const PolarGrid& grid, int channels, const LightPipelineOptions& options) {
  if (grid.rings < 1) return out_of_range("rings", grid.rings, "1 and more");
  if (grid.sectors < 1) return out_of_range("sectors", grid.sectors, "1 and more");
  if (!(grid.theta_max_rad > 0 && grid.theta_max_rad <= kPi * (1 + 1e-12)))
    return out_of_range("theta_max", grid.theta_max_rad, "above 0 to pi");
  if (channels != 1 && channels != 3) return out_of_range("channels", channels, "1 or 3");
  if (options.count < 1 || options.count > kMostLights)
    return out_of_range("count", options.count, "1 to 100000");
  if (options.sampler == LightPipelineOptions::Sampler::best && options.count > kMostPlacedLights)
    return out_of_range("count", options.count, "1 to " + std::to_string(kMostPlacedLights) + " with best");
  if (options.clusters < 0 || options.clusters > kMostLights)
    return out_of_range("clusters", options.clusters, "0 (none) to 100000");
  return {};
}

std::vector<RingCoordinates> light_points(const LightPipelineOptions& options) {
  if (options.sampler == LightPipelineOptions::Sampler::best) return {};
  std::vector<Vec2d> square = halton_points(static_cast<std::size_t>(options.count), options.seed);
  if (options.relaxed) relax_on_torus(square);
  return options.sampler == LightPipelineOptions::Sampler::havran ? warp_points<HavranTransform>(square)
                                                                  : warp_points<StandardInversion>(square);
}

}  // namespace

struct LightPipeline::State {
  State(const PolarGrid& grid, int map_channels, const LightPipelineOptions& o)
      : options(o),
        channels(map_channels),
        points(light_points(o)),
        distribution(grid),
        seam(grid),
        sampled(points.size()),
        lights(points.size()) {
    if (o.sampler == LightPipelineOptions::Sampler::best)
      best.emplace(grid, o.count);
    else if (o.clusters > 0)
      clustering.emplace(o.clusters, grid.theta_max_rad);
  }

  void sample(const PolarMap& map) noexcept {
    distribution.build(map);
    seam.follow(distribution);
    if (options.sampler == LightPipelineOptions::Sampler::havran)
      sample_lights(HavranTransform(distribution, seam), map, points, sampled);
    else
      sample_lights(StandardInversion(distribution, seam), map, points, sampled);
  }

  // The lights after the filter, as the published kind.
  void list(const LightArrays& from) noexcept {
    for (std::size_t i = 0; i < lights.size(); ++i)
      lights[i] = {{from.x[i], from.y[i], from.z[i]},
                   {from.r[i], from.g[i], from.b[i]},
                   -1,
                   static_cast<std::uint32_t>(i)};
  }

  LightPipelineOptions options;
  int channels;
  std::vector<RingCoordinates> points;
  RingDistribution distribution;
  AzimuthSeam seam;
  LightArrays sampled;
  std::optional<BestLights> best;
  std::optional<LightFilter> filter;
  LightArrays filtered;  // empty without a filter
  std::optional<Clustering> clustering;
  std::vector<DirectionalLight> lights;
  Rgb total = Rgb::Zero();
  Rgb map_total = Rgb::Zero();
};

Result<LightPipeline> LightPipeline::create(const PolarGrid& grid, int channels,
                                            const LightPipelineOptions& options) {
  if (Status status = check(grid, channels, options); !status) return status.error();
  std::optional<FirDesign> design;
  if (options.filter == TemporalFilter::fir && options.sampler != LightPipelineOptions::Sampler::best) {
    Result<FirDesign> made =
        design_fir({options.rate_hz, options.pass_hz, options.stop_hz, options.filter_order});
    if (!made) return made.error();
    design = std::move(made).value();
  }
  auto state = std::make_unique<State>(grid, channels, options);
  if (design) {
    state->filter.emplace(design->taps, state->points.size(), grid.theta_max_rad);
    state->filtered = LightArrays(state->points.size());
  }
  return LightPipeline(std::move(state));
}

LightPipeline::LightPipeline(std::unique_ptr<State> state) : state_(std::move(state)) {}
LightPipeline::LightPipeline(LightPipeline&&) noexcept = default;
LightPipeline& LightPipeline::operator=(LightPipeline&&) noexcept = default;
LightPipeline::~LightPipeline() = default;

std::span<const DirectionalLight> LightPipeline::process(const PolarMap& map) noexcept {
  State& s = *state_;
  verify_bug(map.channels == s.channels, "the map has other channels than the pipeline");
  if (s.best) {
    const std::span<const DirectionalLight> best = s.best->process(map);
    s.total = s.map_total = s.best->total_illuminance().cast<float>();
    return best;
  }
  s.sample(map);
  if (s.filter) s.filter->apply(s.sampled, s.filtered);
  const LightArrays& lights = s.filter ? s.filtered : s.sampled;
  s.list(lights);
  const std::span<const DirectionalLight> out = s.clustering ? s.clustering->apply(lights) : unclustered();
  Rgbd total = Rgbd::Zero();
  for (const DirectionalLight& light : out) total += light.illuminance.cast<double>();
  s.total = total.cast<float>();
  s.map_total = s.distribution.total_illuminance().cast<float>();
  return out;
}

std::span<const DirectionalLight> LightPipeline::unclustered() const noexcept {
  return state_->lights;
}
Rgb LightPipeline::total_illuminance() const noexcept {
  return state_->total;
}
Rgb LightPipeline::map_illuminance() const noexcept {
  return state_->map_total;
}
double LightPipeline::delay_frames() const noexcept {
  return state_->filter ? state_->filter->delay_frames() : 0;
}

void LightPipeline::reset() noexcept {
  state_->seam.reset();
  if (state_->best) state_->best->reset();
  if (state_->filter) state_->filter->reset();
}

}  // namespace lightwell
