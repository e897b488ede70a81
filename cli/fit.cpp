// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "cli/command.h"
#include "interface/atomic_file.h"
#include "interface/environment_io.h"
#include "interface/fit_json.h"
#include "interface/option_range.h"
#include "interface/printable.h"
#include "interface/same_file.h"
#include "lighting/fit/few_lights.h"
#include "lighting/lat_long_image.h"

namespace lightwell::cli {
namespace {

struct FitOptions {
  std::string environment;
  std::optional<std::int64_t> lights;
  std::optional<double> max_error;
  bool with_shadow = false;
  double rotate_y_deg = 0;
  std::string out;
  bool json = false;
};

Result<FewLightsOptions> checked(const FitOptions& options) {
  if (options.lights.has_value() == options.max_error.has_value())
    return usage(options.lights ? "--lights and --max-error: allowed one of them"
                                : "--lights or --max-error is needed");
  FewLightsOptions fit;
  fit.lights = static_cast<int>(options.lights.value_or(kMostFittedLights));
  fit.max_error = options.max_error;
  fit.with_shadow = options.with_shadow;
  if (fit.max_error && fit.with_shadow)
    return usage("--with-shadow needs --lights: --max-error bounds the probe alone");
  if (!options.out.empty()) {
    if (const Status named = check_output_name(options.out); !named) return named.error();
    if (const Status other = check_output_is_no_input(options.out, {options.environment}); !other)
      return other.error();
  }
  return fit;
}

void report(const FitOptions& options, const FewLightsFit& fit, double ms) {
  for (const std::string& remark : remarks(fit)) std::fprintf(stderr, "lightwell: %s\n", remark.c_str());
  if (options.json) {
    auto result = nlohmann::ordered_json::parse(fit_to_json(fit, true));
    result["count"] = fit.count;
    result["ms"] = ms;
    if (!options.out.empty()) result["out"] = options.out;
    std::printf("%s\n", result.dump().c_str());
    return;
  }
  std::fprintf(stderr, "lightwell: ambient and %d light%s, residual %.4g%s%s\n", fit.count,
               fit.count == 1 ? "" : "s", fit.residual, options.out.empty() ? "" : " to ",
               options.out.c_str());
}

int run(const FitOptions& options) {
  const auto asked = checked(options);
  if (!asked) return fail(asked.error());
  const auto environment = read_environment(options.environment);
  if (!environment) return fail(environment.error());
  if (const std::string remark = environment->remark(options.environment); !remark.empty())
    std::fprintf(stderr, "lightwell: %s\n", printable(remark).c_str());
  const PolarMap map = polar_map_from_lat_long(environment->image, false, options.rotate_y_deg * kPi / 180);
  const auto begin = std::chrono::steady_clock::now();
  const auto fit = fit_few_lights(map, *asked);
  const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - begin;
  if (!fit) return fail({fit.error().kind, options.environment + ": " + fit.error().message});
  if (!fit->reached) {
    char text[160];
    std::snprintf(text, sizeof text,
                  ": --max-error %g is not reached: the most lights allowed, %d, leave %.3g",
                  *options.max_error, kMostFittedLights, fit->residual);
    return fail({ErrorKind::failed, options.environment + text});
  }
  if (!options.out.empty())
    if (const Status status = write_file_atomically(options.out, fit_to_json(*fit)); !status)
      return fail(status.error());
  report(options, *fit, taken.count());
  return 0;
}

}  // namespace

Command add_fit(CLI::App& app) {
  const auto o = std::make_shared<FitOptions>();
  CLI::App* command = app.add_subcommand(
      "fit", "Ambient and a few directional lights that shade a white sphere as the image does");
  command->footer(
      "Example: lightwell fit env.exr --lights 4 --out fit.json\n"
      "         lightwell fit env.exr --max-error 0.02 --json --out fit.json");
  command
      ->add_option("environment", o->environment,
                   "Latitude–longitude image, EXR or Radiance HDR; all of the sphere counts")
      ->required()
      ->type_name("ENV");
  command->add_option("--lights", o->lights, "Number of lights, 1 to 16")
      ->check(whole_numbers(1, kMostFittedLights))
      ->type_name("M");
  command
      ->add_option("--max-error", o->max_error,
                   "Instead: the fewest lights that leave no larger relative RMSE of the sphere's irradiance")
      ->check(numbers_above_0_to(1, "above 0 to 1"))
      ->type_name("E");
  command->add_flag("--with-shadow", o->with_shadow,
                    "Fit the sphere's shadow on the ground as well: tells more than six lights apart");
  command->add_option("--rotate-y", o->rotate_y_deg, "Turn the image about +Y: azimuth λ comes to λ + DEG")
      ->check(numbers_from(-360, 360, "-360 to 360 degrees"))
      ->type_name("DEG");
  command->add_option("--out", o->out, "Light set, JSON, with residual, confidence and remarks")
      ->check(output_file())
      ->type_name("FILE");
  command->add_flag("--json", o->json, "Machine-readable result on stdout");
  return {command, [o] { return run(*o); }};
}

}  // namespace lightwell::cli
