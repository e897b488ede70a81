// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/coherence.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>

#include "lighting/decomposition/decompose.h"
#include "lighting/light_pipeline.h"

namespace lightwell::bench {
namespace {

using Clock = std::chrono::steady_clock;

Timing timing_of(std::vector<double> ms) {
  if (ms.empty()) return {};
  std::sort(ms.begin(), ms.end());
  const auto at = [&](double q) {
    return ms[static_cast<std::size_t>(std::lround(q * static_cast<double>(ms.size() - 1)))];
  };
  return {at(0.1), at(0.5), at(0.99), ms.size()};
}

// One follower on its way through a sequence.
struct Run {
  const Follower* follower = nullptr;
  Stepper step;
  LightSet set;
  std::vector<double> ms;
  std::vector<CoherenceMeter> meters;  // the whole set's, then one a prefix
};

Follower every_frame_anew(Method method, int count) {
  return {std::string(name(method)), [=] {
            return [=](const PolarMap& map, LightSet& set) {
              auto lights = decompose(map, method, count);
              if (lights) set = std::move(lights).value();
            };
          }};
}

Follower pipeline(Method method, int count, TemporalFilter filter, const std::string& name_of_filter) {
  return {std::string(name(method)) + name_of_filter, [=] {
            auto state = std::make_shared<std::optional<LightPipeline>>();
            return [=](const PolarMap& map, LightSet& set) {
              if (!*state) {
                LightPipelineOptions options;
                options.count = count;
                options.sampler = *sampler_of(method);
                options.relaxed = method == Method::havran;
                options.filter = filter;
                options.rate_hz = 21;  // the paper's camera and filter: Havran et al. 2005, section 4.2
                options.pass_hz = 7;
                options.stop_hz = 9;
                options.clusters = 0;
                state->emplace(LightPipeline::create(map.grid, map.channels, options).value());
              }
              const auto lights = (*state)->process(map);
              set.lights.assign(lights.begin(), lights.end());
              set.total_illuminance = (*state)->total_illuminance();
            };
          }};
}

Row row_of(const FollowedRow& followed) {
  Row row{followed.sequence, followed.follower, followed.timing, {}};
  if (followed.prefix > 0) row.name += ", first " + std::to_string(followed.prefix);
  const Coherence& c = followed.coherence;
  row.values = {{"shadow_error", c.shadow.error},
                {"shadow_excess", c.shadow.excess},
                {"shadow_change_error", c.shadow.change_error},
                {"shadow_largest_excess", c.shadow.largest_excess},
                {"reference_change", c.shadow.reference_change},
                {"irradiance_error", c.irradiance.error},
                {"irradiance_excess", c.irradiance.excess},
                {"power_lag_frames", c.power_lag_frames},
                {"direction_lag_frames", c.direction_lag_frames},
                {"cold_ms", followed.cold_ms}};
  return row;
}

}  // namespace

std::vector<FollowedRow> follow(const Sequence& sequence, const std::vector<Follower>& followers) {
  PolarMap map = sequence_map();
  const EvaluationGeometry geometry(map.grid);
  std::vector<Run> runs;
  for (const Follower& follower : followers) {
    Run run{&follower, follower.make(), {}, {}, {CoherenceMeter()}};
    for (const std::size_t prefix : follower.prefixes) run.meters.emplace_back(Occluder::sphere, prefix);
    runs.push_back(std::move(run));
  }
  for (int frame = 0; frame < sequence.frames; ++frame) {
    sequence.draw(frame, map);
    const ReferenceFrame reference = reference_frame(geometry, map);
    for (Run& run : runs) {
      const auto begin = Clock::now();
      run.step(map, run.set);
      run.ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
      for (CoherenceMeter& meter : run.meters) meter.add(reference, run.set);
    }
  }
  std::vector<FollowedRow> rows;
  for (const Run& run : runs)
    for (std::size_t i = 0; i < run.meters.size(); ++i)
      rows.push_back({sequence.name, run.follower->name, i == 0 ? 0 : run.follower->prefixes[i - 1],
                      run.meters[i].result(), timing_of({run.ms.begin() + 1, run.ms.end()}), run.ms.front()});
  return rows;
}

std::vector<Follower> all_followers(int count) {
  std::vector<Follower> all;
  for (const Method method : kMethods)
    all.push_back(sampler_of(method) ? pipeline(method, count, TemporalFilter::none, "")
                                     : every_frame_anew(method, count));
  for (const Method method : kMethods)
    if (sampler_of(method)) all.push_back(pipeline(method, count, TemporalFilter::fir, " + FIR"));
  return all;
}

std::vector<Row> coherence_suite(const Options& options) {
  const std::filesystem::path maps =
      options.data_folder.empty() ? "" : std::filesystem::path(options.data_folder) / "env";
  std::vector<Row> rows;
  std::vector<Follower> followers = all_followers(options.lights);
  std::erase_if(followers,
                [&](const Follower& f) { return f.name.find(options.only_name) == std::string::npos; });
  for (const Sequence& sequence : sequences(maps)) {
    if (sequence.name.find(options.only_setting) == std::string::npos) continue;
    for (const FollowedRow& followed : follow(sequence, followers)) rows.push_back(row_of(followed));
  }
  return rows;
}

}  // namespace lightwell::bench
