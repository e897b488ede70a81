// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "cli/command.h"
#include "cli/evaluate.h"
#include "cli/progress.h"
#include "interface/environment_io.h"
#include "interface/light_set_io.h"
#include "interface/numbered_sequence.h"
#include "interface/printable.h"
#include "lighting/evaluation/coherence.h"
#include "lighting/lat_long_image.h"

namespace lightwell::cli {
namespace {

using Json = nlohmann::ordered_json;

Json steadiness(const Steadiness& s) {
  return {{"error", s.error},
          {"largest_error", s.largest_error},
          {"reference_change", s.reference_change},
          {"change", s.change},
          {"excess", s.excess},
          {"change_error", s.change_error},
          {"largest_excess", s.largest_excess}};
}

// What is followed through the sequence: one meter each.
struct Meters {
  std::vector<CoherenceMeter> prefixes;  // under the sphere: of the whole set, then of each prefix
  struct Body {
    std::optional<EvaluationGeometry> geometry;
    CoherenceMeter meter;
  };
  std::vector<Body> bodies;  // the other occluders that were asked for
  std::optional<EvaluationGeometry> sphere;

  explicit Meters(const EvaluateOptions& options) {
    prefixes.emplace_back();
    for (const std::size_t count : options.prefixes) prefixes.emplace_back(Occluder::sphere, count);
    for (const Occluder occluder : options.occluders) bodies.push_back({{}, CoherenceMeter(occluder)});
  }

  void add(const EvaluateOptions& options, const PolarMap& map, const LightSet& set) {
    if (!sphere) {
      sphere.emplace(map.grid);
      for (std::size_t i = 0; i < bodies.size(); ++i)
        bodies[i].geometry.emplace(map.grid, options.occluders[i]);
    }
    const ReferenceFrame reference = reference_frame(*sphere, map);
    for (CoherenceMeter& meter : prefixes) meter.add(reference, set);
    for (Body& body : bodies) body.meter.add(reference_frame(*body.geometry, map), set);
  }
};

Json result_of(const EvaluateOptions& options, const Meters& meters, std::size_t frames, double ms) {
  const Coherence whole = meters.prefixes.front().result();
  Json result = {{"irradiance_rel_rmse", whole.irradiance.error},
                 {"shadow_rel_rmse", whole.shadow.error},
                 {"ms", ms},
                 {"frames", frames},
                 {"lit_frames", whole.frames},
                 {"shadow", steadiness(whole.shadow)},
                 {"irradiance", steadiness(whole.irradiance)},
                 {"power_lag_frames", whole.power_lag_frames},
                 {"direction_lag_frames", whole.direction_lag_frames}};
  for (std::size_t i = 0; i < meters.bodies.size(); ++i)
    result["occluders"][std::string(name(options.occluders[i]))] =
        steadiness(meters.bodies[i].meter.result().shadow);
  for (std::size_t i = 0; i < options.prefixes.size(); ++i) {
    const Coherence c = meters.prefixes[i + 1].result();
    result["prefixes"].push_back({{"lights", options.prefixes[i]},
                                  {"shadow", steadiness(c.shadow)},
                                  {"irradiance", steadiness(c.irradiance)}});
  }
  return result;
}

void print_line(const std::string& what, const Json& s) {
  std::printf("%-18s error %.5f  excess %.5f  (light's own change %.5f, error of the change %.5f)\n",
              what.c_str(), s["error"].get<double>(), s["excess"].get<double>(),
              s["reference_change"].get<double>(), s["change_error"].get<double>());
}

void print_text(const Json& result) {
  print_line("irradiance", result["irradiance"]);
  print_line("shadow", result["shadow"]);
  if (result.contains("occluders"))
    for (const auto& [occluder, s] : result["occluders"].items()) print_line("  " + occluder, s);
  if (result.contains("prefixes"))
    for (const auto& entry : result["prefixes"])
      print_line("  first " + std::to_string(entry["lights"].get<std::size_t>()), entry["shadow"]);
  const auto lag = [](double frames) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1f frames", frames);
    return frames == frames ? std::string(text) : std::string("not told by this sequence");
  };
  std::printf("lag of power       %s\nlag of direction   %s\n(relative RMSE; mean of %zu frames)\n",
              lag(result["power_lag_frames"].get<double>()).c_str(),
              lag(result["direction_lag_frames"].get<double>()).c_str(),
              result["lit_frames"].get<std::size_t>());
}

}  // namespace

int evaluate_sequence(const EvaluateOptions& options) {
  const auto files = sequence_files(options.environment);
  if (!files) return fail(files.error());
  const auto sets = read_light_sets(options.lights);
  if (!sets) return fail(sets.error());
  if (sets->size() != files->size())
    return fail({ErrorKind::bad_input, options.lights + ": has " + std::to_string(sets->size()) +
                                           " light sets, the sequence " + std::to_string(files->size()) +
                                           " frames: allowed is one set a frame"});
  for (std::size_t i = 0; i < sets->size(); ++i)
    if ((*sets)[i].coverage != sets->front().coverage)
      return fail({ErrorKind::bad_input, options.lights + ": set " + std::to_string(i + 1) +
                                             ": coverage differs from the first set's"});
  const bool hemisphere = sets->front().coverage == Coverage::hemisphere;
  Meters meters(options);
  Progress progress(files->size());
  std::optional<PolarGrid> grid;
  double ms = 0;
  for (std::size_t i = 0; i < files->size(); ++i) {
    const auto environment = read_environment((*files)[i]);
    if (!environment) return fail(environment.error());
    if (const std::string remark = environment->remark((*files)[i]); !remark.empty())
      std::fprintf(stderr, "lightwell: %s\n", printable(remark).c_str());
    const auto begin = std::chrono::steady_clock::now();
    const PolarMap map = polar_map_from_lat_long(environment->image, hemisphere, options.rotate_y_rad);
    if (grid && !(*grid == map.grid))
      return fail(
          {ErrorKind::bad_input, (*files)[i].string() + ": has another size than the frames before it"});
    grid = map.grid;
    meters.add(options, map, (*sets)[i]);
    ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    progress.done(i + 1);
  }
  const Json result = result_of(options, meters, files->size(), ms);
  if (options.json)
    std::printf("%s\n", result.dump().c_str());
  else
    print_text(result);
  return 0;
}

}  // namespace lightwell::cli
