// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/error_curves.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "bench/followers.h"
#include "bench/painting.h"
#include "bench/python_peers.h"
#include "bench/real_maps.h"
#include "lighting/evaluation/evaluate.h"

namespace lightwell::bench {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kFewestLights = 4;
constexpr int kMostLightsMeasured = 1024;

double ms_of(const std::function<void()>& work) {
  const auto begin = Clock::now();
  work();
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

double median_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// A first frame, then the same again: up to five times or for 30 ms; without state
// the first counts too.
struct Measured {
  double cold_ms = 0, warm_ms = 0;
};
Measured step_and_time(const Stepper& step, bool keeps_state, const PolarMap& map, LightSet& set) {
  constexpr std::size_t kRuns = 5;
  Measured measured;
  measured.cold_ms = ms_of([&] { step(map, set); });
  std::vector<double> warm;
  if (!keeps_state) warm.push_back(measured.cold_ms);
  double spent = measured.cold_ms;
  while (warm.empty() || (warm.size() < kRuns && spent < 30)) {
    warm.push_back(ms_of([&] { step(map, set); }));
    spent += warm.back();
  }
  measured.warm_ms = median_of(std::move(warm));
  return measured;
}

// Sums of logarithms, for the geometric mean; errors below a float's rounding count as that.
struct GeometricMean {
  double sum = 0;
  std::size_t count = 0;
  void add(double v) {
    sum += std::log(std::max(v, 1e-7));
    ++count;
  }
  [[nodiscard]] double value() const { return std::exp(sum / static_cast<double>(count)); }
};

struct Subject {
  const PolarMap* map;
  LightEvaluator evaluator;
};

Row error_row(const Follower& follower, int count, const std::vector<Subject>& subjects) {
  std::vector<double> cold, warm;
  GeometricMean irradiance, shadow;
  LightSet set;
  for (const Subject& subject : subjects) {
    const Measured measured = step_and_time(follower.make(count), follower.keeps_state, *subject.map, set);
    cold.push_back(measured.cold_ms);
    warm.push_back(measured.warm_ms);
    const LightError error = subject.evaluator.error(set);
    irradiance.add(error.irradiance_rel_rmse);
    shadow.add(error.shadow_rel_rmse);
  }
  Row row{"error", follower.name, timing_of(warm), {}};
  row.values = {{"lights", count},
                {"irradiance_rel_rmse", irradiance.value()},
                {"shadow_rel_rmse", shadow.value()},
                {"cold_ms", median_of(cold)},
                {"maps", static_cast<double>(subjects.size())}};
  return row;
}

// The first n of sets of 64 lights of the project's own method, as a reader takes them.
std::vector<Row> prefix_rows(const std::vector<Subject>& subjects) {
  constexpr int kWhole = 64;
  const Follower best = method_follower(Method::best);
  std::vector<LightSet> sets(subjects.size());
  std::vector<double> ms;
  for (std::size_t i = 0; i < subjects.size(); ++i)
    ms.push_back(step_and_time(best.make(kWhole), best.keeps_state, *subjects[i].map, sets[i]).warm_ms);
  std::vector<Row> rows;
  for (int count = kFewestLights; count <= kWhole; count *= 2) {
    GeometricMean irradiance, shadow;
    for (std::size_t i = 0; i < subjects.size(); ++i) {
      const LightError error =
          subjects[i].evaluator.error(take_lights(sets[i], static_cast<std::size_t>(count)));
      irradiance.add(error.irradiance_rel_rmse);
      shadow.add(error.shadow_rel_rmse);
    }
    rows.push_back({"prefix", "best, first of 64", timing_of(ms), {}});
    rows.back().values = {
        {"lights", count}, {"irradiance_rel_rmse", irradiance.value()}, {"shadow_rel_rmse", shadow.value()}};
  }
  return rows;
}

std::vector<Row> python_peer_rows(const Options& options, const std::vector<NamedMap>& maps,
                                  const std::vector<Subject>& subjects) {
  std::vector<int> counts;
  for (int count = kFewestLights; count <= kMostLightsMeasured; count *= 4) counts.push_back(count);
  std::vector<Row> rows;
  for (const PythonPeer& peer : python_peers(options.peers_folder, maps, counts))
    for (const int count : counts) {
      GeometricMean irradiance, shadow;
      std::vector<double> ms;
      for (const PeerSet& made : peer.sets) {
        if (made.count != count) continue;
        const LightError error = subjects[made.map].evaluator.error(made.set);
        irradiance.add(error.irradiance_rel_rmse);
        shadow.add(error.shadow_rel_rmse);
        ms.push_back(made.ms);
      }
      if (ms.empty()) continue;
      Row row{"error", peer.name, timing_of(ms), {}};
      row.values = {{"lights", count},
                    {"irradiance_rel_rmse", irradiance.value()},
                    {"shadow_rel_rmse", shadow.value()},
                    {"maps", static_cast<double>(ms.size())}};
      rows.push_back(std::move(row));
    }
  return rows;
}

PolarMap painted_sky(const PolarGrid& grid) {
  PolarMap map = PolarMap::make(grid, 3);
  paint(map, sky_radiance);
  add_disc(map, from_degrees(48, 100), 0.6, Rgb(5400, 5000, 4200));
  return map;
}

// Warm frames of one follower for a tenth of a case's time, at least one.
Row growth_row(const std::string& setting, const Follower& follower, int count, const PolarMap& map,
               double seconds) {
  const Stepper step = follower.make(count);
  LightSet set;
  Row row{setting, follower.name, {}, {}};
  const double cold = ms_of([&] { step(map, set); });
  std::vector<double> ms;
  double spent = 0;
  do {
    ms.push_back(ms_of([&] { step(map, set); }));
    spent += ms.back();
  } while (spent < 100 * seconds && ms.size() < 200);
  row.timing = timing_of(std::move(ms));
  row.values = {{"lights", count}, {"pixels", static_cast<double>(map.grid.size())}, {"cold_ms", cold}};
  return row;
}

}  // namespace

std::vector<Row> error_rows(const Options& options) {
  std::vector<NamedMap> maps;
  if (!options.data_folder.empty()) maps = real_maps(std::filesystem::path(options.data_folder) / "env");
  if (maps.empty()) {
    std::fprintf(stderr, "no real maps (--data FOLDER, with env/ in it): painted ones stand in\n");
    maps = painted_maps();
  }
  std::vector<Subject> subjects;
  const EvaluationGeometry geometry(maps.front().map.grid);
  for (const NamedMap& named : maps) subjects.push_back({&named.map, LightEvaluator(geometry, named.map)});

  std::vector<Follower> followers = all_methods();
  for (Follower& peer : peers()) followers.push_back(std::move(peer));
  std::vector<Row> rows;
  for (const Follower& follower : followers) {
    double last_ms = 0;
    for (int count = kFewestLights; count <= kMostLightsMeasured; count *= 2) {
      // Twice the lights take two to four times as long.
      if (3 * last_ms > 1000 * (2 + 25 * options.seconds_per_case)) {
        std::fprintf(stderr, "%s: from %d lights on left out, %g s for all maps are too long (--seconds)\n",
                     follower.name.c_str(), count, last_ms / 1000);
        break;
      }
      last_ms = ms_of([&] { rows.push_back(error_row(follower, count, subjects)); });
    }
  }
  for (Row& row : prefix_rows(subjects)) rows.push_back(std::move(row));
  for (Row& row : python_peer_rows(options, maps, subjects)) rows.push_back(std::move(row));
  return rows;
}

std::vector<Row> growth_rows(const Options& options) {
  const double slowest_ms = 200 * options.seconds_per_case + 20;  // the next would take four times as long
  std::vector<Row> rows;
  const PolarMap map = painted_sky({90, 360, kPi / 2});
  for (const Follower& follower : all_methods())
    for (int count = 8; count <= kMostLightsMeasured; count *= 2) {
      rows.push_back(growth_row("growth, lights", follower, count, map, options.seconds_per_case));
      if (rows.back().timing.p50_ms > slowest_ms) break;
    }
  std::vector<PolarMap> sizes;
  for (const int scale : {1, 2, 4, 8}) sizes.push_back(painted_sky({90 * scale, 360 * scale, kPi / 2}));
  for (const Follower& follower : all_methods())
    for (const PolarMap& size : sizes) {
      rows.push_back(growth_row("growth, pixels", follower, 64, size, options.seconds_per_case));
      if (rows.back().timing.p50_ms > slowest_ms) break;
    }
  return rows;
}

}  // namespace lightwell::bench
