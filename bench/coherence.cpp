// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/coherence.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numeric>
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

// Without those that would hold up thousands of frames.
std::vector<Follower> at_frame_rate(std::vector<Follower> followers, const Options& options) {
  const double most_ms = 10 * std::max(0.2, options.seconds_per_case);
  PolarMap map = sequence_map();
  const Sequence sequence = sun_at_rate(60);
  std::erase_if(followers, [&](const Follower& follower) {
    const Stepper step = follower.make(options.lights);
    LightSet set;
    double least_ms = 1e9;  // what else the machine does only adds to it
    for (int frame = 0; frame < 4; ++frame) {
      sequence.draw(frame, map);
      const auto begin = Clock::now();
      step(map, set);
      least_ms = std::min(least_ms, std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
    }
    if (least_ms <= most_ms) return false;
    std::fprintf(stderr, "%s: %.3g ms a frame, left out of moving lights (--seconds)\n",
                 follower.name.c_str(), least_ms);
    return true;
  });
  return followers;
}

std::vector<Follower> asked_followers(const Options& options) {
  std::vector<Follower> all = all_followers();
  std::erase_if(all, [&](const Follower& f) { return f.name.find(options.only_name) == std::string::npos; });
  return all;
}

Rgbd sum_of_lights(const LightSet& set) {
  Rgbd sum = Rgbd::Zero();
  for (const DirectionalLight& light : set.lights) sum += light.illuminance.cast<double>();
  return sum;
}

// What a series of total powers does with flicker, and with a lamp that goes dark in a frame.
struct SwitchedLamp {
  double swing = 0, passed_in_frame = 0, latency_frames = 0;
};
SwitchedLamp switched_lamp(const std::vector<double>& power, int settled, int switched) {
  const auto at = [&](int frame) { return power.begin() + frame; };
  const auto mean = [&](int from, int to) { return std::accumulate(at(from), at(to), 0.0) / (to - from); };
  const double before = mean(settled, switched);
  const double after = mean(switched + 12, switched + 24);  // whole periods of three frames
  const auto [least, largest] = std::minmax_element(at(settled), at(switched));
  SwitchedLamp lamp{(*largest - *least) / (2 * before), 0, 0};
  // Of flicker that is left only its mean over a period says where the step is.
  const auto passed = [&](int frame) {
    return (before - power[static_cast<std::size_t>(frame)]) / (before - after);
  };
  lamp.passed_in_frame = passed(switched);
  int frame = switched;
  while (frame < switched + 12 && passed(frame) < 0.5) ++frame;
  lamp.latency_frames = frame - switched;
  return lamp;
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
  std::vector<Follower> followers = asked_followers(options);
  if (options.only_name.empty()) followers = at_frame_rate(std::move(followers), options);
  const auto lights = static_cast<std::size_t>(options.lights);
  for (Follower& follower : followers)
    if (follower.name == name(Method::best) && lights >= 4) follower.prefixes = {lights / 4, lights / 2};
  std::vector<Row> rows;
  for (const Sequence& sequence : asked_sequences(options))
    for (const FollowedRow& followed : follow(sequence, followers, options.lights))
      rows.push_back(row_of(followed));
  return rows;
}

std::vector<Row> temporal_rows(const Options& options) {
  const std::vector<Follower> followers = at_frame_rate(asked_followers(options), options);
  std::vector<Means> means(followers.size());
  for (const Sequence& sequence : asked_sequences(options)) {
    const std::vector<FollowedRow> followed = follow(sequence, followers, options.lights);
    for (std::size_t i = 0; i < followed.size(); ++i) means[i].add(followed[i]);
  }
  std::vector<Row> rows;
  for (std::size_t i = 0; i < followers.size(); ++i)
    if (means[i].sequences > 0) rows.push_back(means[i].row(followers[i].name));
  return rows;
}

std::vector<Row> flicker_rows(const Options& options) {
  constexpr int kSettled = 24;  // frames that every filter has learnt in
  std::vector<Follower> followers = {
      method_follower(Method::best), without_flicker(method_follower(Method::best)),
      method_follower(Method::havran), without_flicker(method_follower(Method::havran))};
  for (const TemporalChoice choice :
       {TemporalChoice::fir, TemporalChoice::minimum_phase, TemporalChoice::one_frame})
    followers.push_back(filtered_follower(Method::havran, choice));
  const Sequence sequence = mains_flicker();
  PolarMap map = sequence_map();
  std::vector<Row> rows;
  double swing_of_map = 0;
  for (std::size_t i = 0; i <= followers.size(); ++i) {  // the map itself, then each
    const Stepper step = i == 0 ? nullptr : followers[i - 1].make(options.lights);
    LightSet set;
    std::vector<double> power, ms;
    for (int frame = 0; frame < sequence.frames; ++frame) {
      sequence.draw(frame, map);
      if (step == nullptr) {
        power.push_back(luminance(total_illuminance(map)));
        continue;
      }
      const auto begin = Clock::now();
      step(map, set);
      ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
      power.push_back(luminance(sum_of_lights(set)));
    }
    const SwitchedLamp lamp = switched_lamp(power, kSettled, kMainsSwitchedFrame);
    if (step == nullptr) {
      swing_of_map = lamp.swing;
      continue;
    }
    Row row{"flicker", followers[i - 1].name, timing_of({ms.begin() + 1, ms.end()}), {}};
    row.values = {{"swing", lamp.swing},
                  {"suppression_db", 20 * std::log10(swing_of_map / std::max(lamp.swing, 1e-9))},
                  {"passed_in_frame", lamp.passed_in_frame},
                  {"latency_frames", lamp.latency_frames}};
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<Row> rate_rows(const Options& options) {
  const std::vector<Follower> followers = at_frame_rate(all_methods(), options);
  std::vector<Row> rows;
  for (const double rate : {15.0, 30.0, 60.0, 120.0, 240.0})
    for (const FollowedRow& followed : follow(sun_at_rate(rate), followers, options.lights)) {
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
