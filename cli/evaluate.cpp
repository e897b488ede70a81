// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/evaluation/evaluate.h"

#include <chrono>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/command.h"
#include "interface/environment_io.h"
#include "interface/light_set_io.h"
#include "interface/option_range.h"
#include "interface/printable.h"
#include "lighting/lat_long_image.h"

namespace lightwell::cli {
namespace {

struct EvaluateOptions {
  std::string environment;
  std::string lights;
  double rotate_y_deg = 0;
  bool json = false;
};

int run(const EvaluateOptions& options) {
  const auto environment = read_environment(options.environment);
  if (!environment) return fail(environment.error());
  const auto set = read_light_set(options.lights);
  if (!set) return fail(set.error());
  if (const std::string remark = environment->remark(options.environment); !remark.empty())
    std::fprintf(stderr, "lightwell: %s\n", printable(remark).c_str());

  const auto begin = std::chrono::steady_clock::now();
  const bool hemisphere = set->coverage == Coverage::hemisphere;
  const PolarMap map =
      polar_map_from_lat_long(environment->image, hemisphere, options.rotate_y_deg * kPi / 180);
  const LightError error = LightEvaluator(map).error(*set);
  const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - begin;

  if (options.json) {
    // An infinite error (lights where the map is black) is null.
    const nlohmann::ordered_json result = {{"irradiance_rel_rmse", error.irradiance_rel_rmse},
                                           {"shadow_rel_rmse", error.shadow_rel_rmse},
                                           {"ms", taken.count()},
                                           {"lights", set->lights.size()},
                                           {"coverage", hemisphere ? "hemisphere" : "sphere"}};
    std::printf("%s\n", result.dump().c_str());
  } else {
    std::printf("irradiance error %.6g\nshadow error     %.6g\n(relative RMSE; %zu lights, %.1f ms)\n",
                error.irradiance_rel_rmse, error.shadow_rel_rmse, set->lights.size(), taken.count());
  }
  return 0;
}

}  // namespace

Command add_evaluate(CLI::App& app) {
  const auto options = std::make_shared<EvaluateOptions>();
  CLI::App* command = app.add_subcommand("evaluate", "Error of a light set against the whole image");
  command->footer("Example: lightwell evaluate env.exr lights.json --json");
  command->add_option("environment", options->environment, "Latitude–longitude image, EXR or Radiance HDR")
      ->required()
      ->type_name("ENV");
  command->add_option("lights", options->lights, "Light set, JSON")->required()->type_name("LIGHTS");
  command->add_option("--rotate-y", options->rotate_y_deg, "Turn the image about +Y first, as `lights` did")
      ->check(numbers_from(-360, 360, "-360 to 360 degrees"))
      ->type_name("DEG");
  command->add_flag("--json", options->json, "Machine-readable result on stdout");
  return {command, [options] { return run(*options); }};
}

}  // namespace lightwell::cli
