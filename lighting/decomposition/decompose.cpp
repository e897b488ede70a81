// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/decompose.h"

#include <limits>
#include <vector>

#include "lighting/decomposition/best_lights.h"
#include "lighting/decomposition/median_cut.h"
#include "lighting/decomposition/uniform_lights.h"

namespace lightwell {
namespace {

// One frame of the daemon's sampler: no filter, no clustering.
Result<std::vector<DirectionalLight>> sampled_lights(const PolarMap& map,
                                                     LightPipelineOptions::Sampler sampler, int count,
                                                     std::uint32_t seed) {
  LightPipelineOptions options;
  options.count = count;
  options.sampler = sampler;
  options.relaxed = sampler == LightPipelineOptions::Sampler::havran;
  options.seed = seed;
  options.filter = TemporalFilter::none;
  options.clusters = 0;
  auto pipeline = LightPipeline::create(map.grid, map.channels, options);
  if (!pipeline) return pipeline.error();
  const auto lights = pipeline->process(map);
  return std::vector<DirectionalLight>(lights.begin(), lights.end());
}

}  // namespace

std::string_view name(Method method) {
  switch (method) {
    case Method::best:
      return "best";
    case Method::standard:
      return "standard";
    case Method::havran:
      return "havran";
    case Method::median_cut:
      return "median-cut";
    case Method::uniform:
      return "uniform";
  }
  return "";
}

std::optional<Method> method_from_name(std::string_view wanted) {
  for (const Method method : kMethods)
    if (name(method) == wanted) return method;
  return std::nullopt;
}

std::string method_names() {
  std::string names;
  for (const Method method : kMethods) names += (names.empty() ? "" : ", ") + std::string(name(method));
  return names;
}

Coverage coverage_of(const PolarGrid& grid) {
  return grid.theta_max_rad > 0.75 * kPi ? Coverage::sphere : Coverage::hemisphere;
}

std::optional<LightPipelineOptions::Sampler> sampler_of(Method method) {
  if (method == Method::standard) return LightPipelineOptions::Sampler::standard;
  if (method == Method::havran) return LightPipelineOptions::Sampler::havran;
  return std::nullopt;
}

Result<LightSet> decompose(const PolarMap& map, Method method, int count, std::uint32_t seed) {
  if (count < 1 || count > kMostLights)
    return Error{ErrorKind::usage,
                 "count is " + std::to_string(count) + ", allowed 1 to " + std::to_string(kMostLights)};
  const Rgbd total = total_illuminance(map);
  if (!(total.maxCoeff() <= static_cast<double>(std::numeric_limits<float>::max())))
    return Error{ErrorKind::bad_input, "total illuminance is beyond a 32 bit float (3.4e38 lux)"};
  LightSet set;
  set.method = name(method);
  set.coverage = coverage_of(map.grid);
  set.total_illuminance = total.cast<float>();
  switch (method) {
    case Method::best:
      set.lights = best_lights(map, count);
      break;
    case Method::median_cut:
      set.lights = median_cut(map, count);
      break;
    case Method::uniform:
      set.lights = uniform_lights(map, count, seed);
      break;
    case Method::standard:
    case Method::havran: {
      auto lights = sampled_lights(map, *sampler_of(method), count, seed);
      if (!lights) return lights.error();
      set.lights = std::move(lights).value();
      break;
    }
  }
  set.has_parents = method == Method::best || method == Method::median_cut;
  return set;
}

}  // namespace lightwell
