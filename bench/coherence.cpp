// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/coherence.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <utility>

namespace lightwell::bench {
namespace {

using Clock = std::chrono::steady_clock;

// One follower on its way through a sequence.
struct Run {
  const Follower* follower = nullptr;
  Stepper step;
  LightSet set;
  std::vector<double> ms;
  std::vector<CoherenceMeter> meters;  // the whole set's, then one a prefix
};

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

std::vector<FollowedRow> follow(const Sequence& sequence, const std::vector<Follower>& followers,
                                int lights) {
  PolarMap map = sequence_map();
  const EvaluationGeometry geometry(map.grid);
  std::vector<Run> runs;
  for (const Follower& follower : followers) {
    Run run{&follower, follower.make(lights), {}, {}, {CoherenceMeter()}};
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

std::vector<Follower> all_followers() {
  std::vector<Follower> all = all_methods();
  for (const Method method : kMethods)
    if (sampler_of(method))
      for (const TemporalChoice choice :
           {TemporalChoice::fir, TemporalChoice::minimum_phase, TemporalChoice::one_frame})
        all.push_back(filtered_follower(method, choice));
  all.push_back(without_flicker(method_follower(Method::median_cut)));
  return all;
}

namespace {

std::vector<Sequence> asked_sequences(const Options& options) {
  std::vector<Sequence> all =
      sequences(options.data_folder.empty() ? "" : std::filesystem::path(options.data_folder) / "env");
  std::erase_if(all,
                [&](const Sequence& s) { return s.name.find(options.only_setting) == std::string::npos; });
  return all;
}

std::vector<Follower> asked_followers(const Options& options) {
  std::vector<Follower> all = all_followers();
  std::erase_if(all, [&](const Follower& f) { return f.name.find(options.only_name) == std::string::npos; });
  return all;
}

// A follower's record over several sequences.
struct Means {
  std::size_t sequences = 0, told = 0;
  double error = 0, excess = 0, change_error = 0, largest_excess = 0, latency = 0;
  std::vector<double> p50_ms;
  double p99_ms = 0;

  void add(const FollowedRow& row) {
    const Steadiness& s = row.coherence.shadow;
    ++sequences;
    error += s.error;
    excess += s.excess;
    change_error += s.change_error;
    largest_excess = std::max(largest_excess, s.largest_excess);
    if (std::isfinite(row.coherence.power_lag_frames)) {
      latency += row.coherence.power_lag_frames;
      ++told;
    }
    p50_ms.push_back(row.timing.p50_ms);
    p99_ms = std::max(p99_ms, row.timing.p99_ms);
  }
  [[nodiscard]] Row row(const std::string& follower) const {
    const auto count = static_cast<double>(sequences);
    Row made{"temporal", follower, timing_of(p50_ms), {}};
    made.timing.p99_ms = p99_ms;
    made.values = {{"shadow_error", error / count},
                   {"shadow_excess", excess / count},
                   {"shadow_change_error", change_error / count},
                   {"shadow_largest_excess", largest_excess},
                   {"latency_frames", latency / static_cast<double>(told)},
                   {"sequences", count}};
    return made;
  }
};

}  // namespace

std::vector<Row> coherence_suite(const Options& options) {
  const std::vector<Follower> followers = asked_followers(options);
  std::vector<Row> rows;
  for (const Sequence& sequence : asked_sequences(options))
    for (const FollowedRow& followed : follow(sequence, followers, options.lights))
      rows.push_back(row_of(followed));
  return rows;
}

std::vector<Row> temporal_rows(const Options& options) {
  const std::vector<Follower> followers = asked_followers(options);
  std::vector<Means> means(followers.size());
  for (const Sequence& sequence : asked_sequences(options)) {
    const std::vector<FollowedRow> rows = follow(sequence, followers, options.lights);
    for (std::size_t i = 0; i < rows.size(); ++i) means[i].add(rows[i]);
  }
  std::vector<Row> rows;
  for (std::size_t i = 0; i < followers.size(); ++i)
    if (means[i].sequences > 0) rows.push_back(means[i].row(followers[i].name));
  return rows;
}

std::vector<Row> rate_rows(const Options& options) {
  std::vector<Row> rows;
  for (const double rate : {15.0, 30.0, 60.0, 120.0, 240.0})
    for (const FollowedRow& followed : follow(sun_at_rate(rate), all_methods(), options.lights)) {
      Row row{"growth, rate", followed.follower, followed.timing, {}};
      row.values = {{"rate_hz", rate},
                    {"share_of_core", followed.timing.p50_ms * rate / 1000},
                    {"shadow_error", followed.coherence.shadow.error},
                    {"shadow_excess", followed.coherence.shadow.excess}};
      rows.push_back(std::move(row));
    }
  return rows;
}

}  // namespace lightwell::bench
