// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/evaluate.h"

#include <chrono>
#include <cstdio>
#include <memory>

#include "cli/command.h"
#include "interface/environment_io.h"
#include "interface/light_set_io.h"
#include "interface/numbered_sequence.h"
#include "interface/option_range.h"
#include "interface/printable.h"
#include "lighting/decomposition/decompose.h"
#include "lighting/evaluation/evaluate.h"
#include "lighting/lat_long_image.h"

namespace lightwell::cli {
namespace {

using Json = nlohmann::ordered_json;

Json prefix_errors(const LightEvaluator& evaluator, const LightSet& set,
                   const std::vector<std::size_t>& prefixes) {
  Json list = Json::array();
  for (const std::size_t count : prefixes) {
    const LightError error = evaluator.error(take_lights(set, count));
    list.push_back({{"lights", count},
                    {"irradiance_rel_rmse", error.irradiance_rel_rmse},
                    {"shadow_rel_rmse", error.shadow_rel_rmse}});
  }
  return list;
}

// An infinite error (lights where the map is black) becomes null.
Json measure(const EvaluateOptions& options, const LatLongImage& image, const LightSet& set) {
  const auto begin = std::chrono::steady_clock::now();
  const PolarMap map =
      polar_map_from_lat_long(image, set.coverage == Coverage::hemisphere, options.rotate_y_rad);
  const LightEvaluator evaluator(map);
  const LightError error = evaluator.error(set);
  const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - begin;
  Json result = {{"irradiance_rel_rmse", error.irradiance_rel_rmse},
                 {"shadow_rel_rmse", error.shadow_rel_rmse},
                 {"ms", taken.count()},
                 {"lights", set.lights.size()},
                 {"coverage", set.coverage == Coverage::hemisphere ? "hemisphere" : "sphere"}};
  for (const Occluder occluder : options.occluders)
    result["occluders"][std::string(name(occluder))] = {
        {"shadow_rel_rmse", occluder == Occluder::sphere
                                ? error.shadow_rel_rmse
                                : LightEvaluator(map, occluder).error(set).shadow_rel_rmse}};
  if (!options.prefixes.empty()) result["prefixes"] = prefix_errors(evaluator, set, options.prefixes);
  return result;
}

void print_text(const Json& result) {
  std::printf("irradiance error %.6g\nshadow error     %.6g\n", result["irradiance_rel_rmse"].get<double>(),
              result["shadow_rel_rmse"].get<double>());
  if (result.contains("occluders"))
    for (const auto& [occluder, error] : result["occluders"].items())
      std::printf("  under a %-8s %.6g\n", occluder.c_str(), error["shadow_rel_rmse"].get<double>());
  if (result.contains("prefixes"))
    for (const auto& entry : result["prefixes"])
      std::printf("  first %zu lights: irradiance %.6g, shadow %.6g\n", entry["lights"].get<std::size_t>(),
                  entry["irradiance_rel_rmse"].get<double>(), entry["shadow_rel_rmse"].get<double>());
  std::printf("(relative RMSE; %zu lights, %.1f ms)\n", result["lights"].get<std::size_t>(),
              result["ms"].get<double>());
}

int evaluate_image(const EvaluateOptions& options) {
  const auto environment = read_environment(options.environment);
  if (!environment) return fail(environment.error());
  const auto set = read_light_set(options.lights);
  if (!set) return fail(set.error());
  if (const std::string remark = environment->remark(options.environment); !remark.empty())
    std::fprintf(stderr, "lightwell: %s\n", printable(remark).c_str());
  const Json result = measure(options, environment->image, *set);
  if (options.json)
    std::printf("%s\n", result.dump().c_str());
  else
    print_text(result);
  return 0;
}

// As typed: --occluder may come several times, and all stands for each.
struct Asked {
  EvaluateOptions options;
  std::vector<std::string> occluders;
  std::vector<std::int64_t> prefixes;
  double rotate_y_deg = 0;
};

int run(Asked asked) {
  for (const std::string& word : asked.occluders) {
    if (word == "all") {
      asked.options.occluders.assign(kOccluders.begin(), kOccluders.end());
      continue;
    }
    const auto occluder = occluder_from_name(word);
    if (!occluder) return fail(usage("--occluder is " + word + ", allowed: " + occluder_names() + ", all"));
    asked.options.occluders.push_back(*occluder);
  }
  for (const std::int64_t count : asked.prefixes)
    asked.options.prefixes.push_back(static_cast<std::size_t>(count));
  asked.options.rotate_y_rad = asked.rotate_y_deg * kPi / 180;
  return is_numbered_sequence(asked.options.environment) ? evaluate_sequence(asked.options)
                                                         : evaluate_image(asked.options);
}

}  // namespace

Command add_evaluate(CLI::App& app) {
  const auto asked = std::make_shared<Asked>();
  CLI::App* command = app.add_subcommand("evaluate", "Error of a light set against the whole image");
  command->footer(
      "Example: lightwell evaluate env.exr lights.json --json\n"
      "         lightwell evaluate 'env_%04d.exr' lights.jsonl --occluder all --prefix 16 --prefix 32");
  command
      ->add_option("environment", asked->options.environment,
                   "Latitude–longitude image, EXR or Radiance HDR, or a numbered sequence ('env_%04d.exr'), "
                   "which also gives excess and lag")
      ->required()
      ->type_name("ENV");
  command->add_option("lights", asked->options.lights, "Light set, JSON; of a sequence one set a line")
      ->required()
      ->type_name("LIGHTS");
  command
      ->add_option("--occluder", asked->occluders,
                   "Shadow error under this too: " + occluder_names() +
                       ", or all; may be given several times. shadow_rel_rmse is always the sphere's")
      ->allow_extra_args(false)
      ->type_name("BODY");
  command
      ->add_option("--prefix", asked->prefixes,
                   "Also of the first N lights, as a reader takes them; may be given several times")
      ->allow_extra_args(false)
      ->check(whole_numbers(1, kMostLights))
      ->type_name("N");
  command->add_option("--rotate-y", asked->rotate_y_deg, "Turn the image about +Y first, as `lights` did")
      ->check(numbers_from(-360, 360, "-360 to 360 degrees"))
      ->type_name("DEG");
  command->add_flag("--json", asked->options.json, "Machine-readable result on stdout");
  return {command, [asked] { return run(*asked); }};
}

}  // namespace lightwell::cli
