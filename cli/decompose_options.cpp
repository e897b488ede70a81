// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/decompose_options.h"

#include "cli/command.h"
#include "interface/option_range.h"

namespace lightwell::cli {

void add_decompose_options(CLI::App& command, DecomposeArguments& arguments) {
  command
      .add_option("--seed", arguments.seed,
                  "Turns the points of standard, havran, penrose and uniform; 0: none")
      ->check(whole_numbers(0, UINT32_MAX))
      ->type_name("S");
  command
      .add_option("--powers", arguments.powers,
                  "Each light's power: cells, the part of the map nearest to it; means, the same, moved to "
                  "that part's middle; equal; default own, as the method says")
      ->type_name("P");
  command
      .add_option(
          "--points", arguments.points,
          "Points that are mapped to the light: with standard halton (default) or random, with havran "
          "relaxed (default) or halton")
      ->type_name("KIND");
  command
      .add_option(
          "--interpolation", arguments.interpolation,
          "With havran, between rings: power, which keeps every place its share (default), or printed, "
          "as in the paper")
      ->type_name("KIND");
}

Result<DecomposeOptions> decompose_options(const DecomposeArguments& arguments, Method method) {
  DecomposeOptions options;
  options.seed = static_cast<std::uint32_t>(arguments.seed);
  if (arguments.powers) {
    const auto powers = powers_from_name(*arguments.powers);
    if (!powers) return usage("--powers is " + *arguments.powers + ", allowed: own, cells, means, equal");
    options.powers = *powers;
  }
  if (arguments.points) {
    options.points = points_from_name(*arguments.points);
    if (!options.points)
      return usage("--points is " + *arguments.points + ", allowed: random, halton, relaxed");
  }
  if (arguments.interpolation) {
    options.interpolation = interpolation_from_name(*arguments.interpolation);
    if (!options.interpolation)
      return usage("--interpolation is " + *arguments.interpolation + ", allowed: power, printed");
  }
  auto all = resolved(method, options);
  if (!all) return usage("--" + all.error().message);
  return all;
}

Status check_carried(const DecomposeOptions& options) {
  if (options.powers != Powers::own)
    return usage("--powers " + std::string(name(options.powers)) + " needs --temporal none in a sequence");
  if (options.points == Points::random) return usage("--points random needs --temporal none in a sequence");
  if (options.interpolation == Interpolation::printed)
    return usage("--interpolation printed needs --temporal none in a sequence");
  return {};
}

void describe(const DecomposeOptions& options, nlohmann::ordered_json& summary) {
  summary["powers"] = name(options.powers);
  if (options.points) summary["points"] = name(*options.points);
  if (options.interpolation) summary["interpolation"] = name(*options.interpolation);
}

}  // namespace lightwell::cli
