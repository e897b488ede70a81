// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "field/walk_take.h"

namespace lightwell::cli {

// `lightwell field build` of a recording instead of a list of pictures.
struct WalkArguments {
  std::string poses, calibration;
  double lag_ms = 0, pose_gap_s = PoseTrack::Limits{}.most_gap_s;
  double redundant = 0.05;
  std::optional<double> spacing_m;  // none: half a cell
  std::vector<const CLI::Option*> options;
};
void add_walk_options(CLI::App& command, WalkArguments& arguments);
// usage that names the first option which a list of pictures has no use for.
Status check_no_walk_options(const WalkArguments& arguments);

// A Matroska file, by its first bytes.
bool is_take(const std::filesystem::path& file);

// usage where the output is the take's pose file, or one of the calibration's.
Status check_output_is_no_walk(const std::filesystem::path& output, const std::filesystem::path& take,
                               const WalkArguments& arguments);
Result<std::shared_ptr<WalkTake>> open_walk(const std::filesystem::path& take, const WalkArguments& arguments,
                                            const FieldGrid& grid, int directions, bool speaks);

// How many frames were kept, and where the others went: for people on stdout, for programs as an object.
void print_walk(const WalkTake& walk);
nlohmann::ordered_json walk_json(const WalkTake& walk, const WalkArguments& arguments);

}  // namespace lightwell::cli
