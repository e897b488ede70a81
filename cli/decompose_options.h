// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "lighting/decomposition/decompose.h"
#include "lighting/result.h"

namespace lightwell::cli {

// --seed, --powers, --points and --interpolation of a command that decomposes maps, as they were typed.
struct DecomposeArguments {
  std::int64_t seed = 0;
  std::optional<std::string> powers;
  std::optional<std::string> points;
  std::optional<std::string> interpolation;
};

void add_decompose_options(CLI::App& command, DecomposeArguments& arguments);

// With the method's defaults filled in.    fails: usage, for a value that does not exist or does not apply
Result<DecomposeOptions> decompose_options(const DecomposeArguments& arguments, Method method);

// What a state carried from frame to frame can do: the powers that its method gives, of a sequence's points.
// fails: usage, naming the option
Status check_carried(const DecomposeOptions& options);

// "powers", and "points" and "interpolation" of a method that has them.
void describe(const DecomposeOptions& options, nlohmann::ordered_json& summary);

}  // namespace lightwell::cli
