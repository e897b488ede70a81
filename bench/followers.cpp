// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/followers.h"

#include <memory>
#include <optional>
#include <random>
#include <utility>

#include "bench/row_column_inversion.h"
#include "lighting/decomposition/best_lights.h"
#include "lighting/light_pipeline.h"
#include "lighting/sampling/azimuth_seam.h"
#include "lighting/sampling/halton.h"
#include "lighting/sampling/light_arrays.h"
#include "lighting/sampling/ring_distribution.h"
#include "lighting/sampling/ring_sampling.h"
#include "lighting/temporal/flicker_filter.h"

namespace lightwell::bench {
namespace {

// Made at the first map, whose grid it is for.
template <class T>
using Late = std::shared_ptr<std::optional<T>>;
template <class T>
Late<T> late() {
  return std::make_shared<std::optional<T>>();
}

Stepper sampler(Method method, int count) {
  return [=, pipeline = late<LightPipeline>()](const PolarMap& map, LightSet& set) {
    if (!*pipeline) {
      LightPipelineOptions options;
      options.count = count;
      options.sampler = *sampler_of(method);
      options.relaxed = method == Method::havran;
      options.filter = TemporalFilter::none;
      options.clusters = 0;
      pipeline->emplace(LightPipeline::create(map.grid, map.channels, options).value());
    }
    const auto lights = (*pipeline)->process(map);
    set.lights.assign(lights.begin(), lights.end());
    set.total_illuminance = (*pipeline)->total_illuminance();
  };
}

Stepper every_frame_anew(Method method, int count) {
  return [=](const PolarMap& map, LightSet& set) { set = decompose(map, method, count).value(); };
}

// As the daemon runs it. Beyond its most lights every frame stands by itself.
Stepper followed_by_best(int count) {
  if (count > kMostPlacedLights) return every_frame_anew(Method::best, count);
  return [=, best = late<BestLights>()](const PolarMap& map, LightSet& set) {
    if (!*best) best->emplace(map.grid, count);
    const auto lights = (*best)->process(map);
    set.lights.assign(lights.begin(), lights.end());
    set.has_parents = true;
    set.total_illuminance = (*best)->total_illuminance().cast<float>();
  };
}

std::vector<Vec2d> random_points(std::size_t count) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Vec2d> points(count);
  for (Vec2d& p : points) p = {uniform(random), uniform(random)};
  return points;
}

Follower row_column(const std::string& name, std::vector<Vec2d> (*points)(std::size_t)) {
  return {name, [=](int count) -> Stepper {
            return [square = points(static_cast<std::size_t>(count)), peer = late<RowColumnInversion>()](
                       const PolarMap& map, LightSet& set) {
              if (!*peer) peer->emplace(map.grid);
              (*peer)->build(map);
              set.lights.resize(square.size());
              for (std::size_t i = 0; i < square.size(); ++i)
                set.lights[i] = (*peer)->sample(map, square[i], square.size());
            };
          }};
}

std::vector<Vec2d> halton(std::size_t count) {
  return halton_points(count);
}

// Havran et al. 2005 to the letter: normalised ring distributions interpolated, the seam at azimuth 0.
Follower havran_as_printed() {
  return {"havran, as printed", [](int count) -> Stepper {
            struct State {
              explicit State(const PolarGrid& grid) : distribution(grid), seam(grid) {}
              RingDistribution distribution;
              AzimuthSeam seam;
            };
            const auto size = static_cast<std::size_t>(count);
            return [points = warp_points<HavranTransform>(halton_points(size)), state = late<State>(),
                    lights = LightArrays(size)](const PolarMap& map, LightSet& set) mutable {
              if (!*state) state->emplace(map.grid);
              State& s = **state;
              s.distribution.build(map);
              s.seam.fix(s.distribution, 0);
              sample_lights(HavranTransform(s.distribution, s.seam, HavranTransform::Interpolation::printed),
                            map, points, lights);
              set.lights.resize(lights.size());
              for (std::size_t i = 0; i < lights.size(); ++i) {
                set.lights[i].direction = {lights.x[i], lights.y[i], lights.z[i]};
                set.lights[i].illuminance = {lights.r[i], lights.g[i], lights.b[i]};
              }
            };
          }};
}

}  // namespace

Follower method_follower(Method method) {
  return {std::string(name(method)),
          [=](int count) {
            return sampler_of(method)       ? sampler(method, count)
                   : method == Method::best ? followed_by_best(count)
                                            : every_frame_anew(method, count);
          },
          {},
          sampler_of(method).has_value() || method == Method::best};
}

Follower filtered_follower(Method method, TemporalChoice choice) {
  return {std::string(name(method)) + ", " + std::string(name(choice)), [=](int count) -> Stepper {
            return [=, sampled = sampler(method, count), filter = late<LightSetFilter>()](const PolarMap& map,
                                                                                          LightSet& set) {
              sampled(map, set);
              if (!*filter)
                filter->emplace(temporal_taps(choice, 21).value(), static_cast<std::size_t>(count),
                                map.grid.theta_max_rad);
              (*filter)->apply(set);
            };
          }};
}

Follower without_flicker(const Follower& follower) {
  return {follower.name + ", mains filter",
          [=](int count) -> Stepper {
            return [step = follower.make(count), filter = late<FlickerFilter>(),
                    steady = std::make_shared<PolarMap>(),
                    frame = 0](const PolarMap& map, LightSet& set) mutable {
              constexpr double kExposure_s = 0.002;
              if (!*filter)
                filter->emplace(FlickerFilter::create(map.radiance.size(), {100, 60, kExposure_s}).value());
              *steady = map;
              (*filter)->apply(frame++ / 60.0, kExposure_s, steady->radiance);
              step(*steady, set);
            };
          },
          follower.prefixes};
}

std::vector<Follower> all_methods() {
  std::vector<Follower> all;
  for (const Method method : kMethods) all.push_back(method_follower(method));
  all.push_back(
      {"best, of one map", [](int count) { return every_frame_anew(Method::best, count); }, {}, false});
  return all;
}

std::vector<Follower> peers() {
  DecomposeOptions cells;
  cells.powers = Powers::cells;
  const Follower havran_cells = {"havran, powers of cells", [=](int count) -> Stepper {
                                   return [=](const PolarMap& map, LightSet& set) {
                                     set = decompose(map, Method::havran, count, cells).value();
                                   };
                                 }};
  return {havran_cells, row_column("row/column inversion, random", random_points),
          row_column("row/column inversion, Halton", halton), havran_as_printed()};
}

}  // namespace lightwell::bench
