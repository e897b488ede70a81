// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

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

// What was wrong with the pictures that this process has read; for several threads at a time.
class PictureFaults {
 public:
  void set(std::size_t picture, std::uint64_t unseen_pixels, std::uint64_t negative_values);
  // Of all ranks' pictures, a line each of what there is: for rank 0 to say.
  [[nodiscard]] std::vector<std::string> remarks(const ProbeTake& take, FieldRanks& ranks) const;

 private:
  mutable std::mutex mutex_;
  std::map<std::size_t, std::array<std::uint64_t, 2>> faults_;
};
// Pixels that are NaN, infinite or above what a field's numbers hold (1e15 cd/m²) were not seen: NaN. Values below 0 are 0.
ProbeTake take_of(ProbeList list, std::shared_ptr<PictureFaults> faults);

}  // namespace lightwell::cli
