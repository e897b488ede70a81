// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include "field/field_builder.h"
#include "field/probe_list.h"

namespace lightwell::cli {

// `lightwell field build` of a list of pictures: what they are pictures of.
struct PictureArguments {
  std::string projection = "latlong", lens;
  double ball_radius_m = 0, blind_cone_deg = 2.1;
  std::optional<double> camera_distance_m;
  std::vector<const CLI::Option*> options;
};
void add_picture_options(CLI::App& command, PictureArguments& arguments);
// usage that names the first option which a recording has no use for.
Status check_no_picture_options(const PictureArguments& arguments);

Result<ProbeProjection> projection_of(const PictureArguments& arguments);
// The pictures of a list as they are now, and how they are read: what an unfinished build must have come from.
Result<std::string> origin_of(const PictureArguments& arguments, const ProbeList& list);
// repaired: set where values were read as 0; said once, where this process speaks.
ProbeTake take_of(ProbeList list, std::shared_ptr<std::atomic<bool>> repaired, bool speaks);

}  // namespace lightwell::cli
