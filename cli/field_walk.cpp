// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/field_walk.h"

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/progress.h"
#include "interface/option_range.h"
#include "interface/pose_file.h"
#include "interface/printable.h"
#include "interface/same_file.h"

namespace lightwell::cli {

void add_walk_options(CLI::App& command, WalkArguments& o) {
  o.options = {
      command
          .add_option("--poses", o.poses, "Of a recording: its pose file [take.poses.csv beside take.mkv]")
          ->type_name("CSV"),
      command
          .add_option("--calibration", o.calibration,
                      "Of a recording: calibration folder [the one attached to it]")
          ->type_name("DIR"),
      command
          .add_option("--lag", o.lag_ms,
                      "Of a recording: milliseconds by which the poses come late, below 0 early")
          ->check(numbers_from(-2000, 2000, "-2000 to 2000 ms"))
          ->capture_default_str()
          ->type_name("MS"),
      command
          .add_option("--pose-gap", o.pose_gap_s,
                      "Of a recording: frames between poses farther apart than this are left out, seconds")
          ->check(numbers_above_0_to(60, "above 0 to 60 seconds"))
          ->capture_default_str()
          ->type_name("S"),
      command
          .add_option(
              "--redundant", o.redundant,
              "Of a recording: leave out a frame that differs from the one kept before it and from the next "
              "by no more than this part of their light; 0: keep all")
          ->check(numbers_from(0, 2, "0 to 2"))
          ->capture_default_str()
          ->type_name("E"),
      command
          .add_option(
              "--spacing", o.spacing_m,
              "Of a recording: leave no frame out where those beside it would be farther apart, metres [half "
              "a cell]")
          ->check(numbers_above_0_to(100, "above 0 to 100 metres"))
          ->type_name("M")};
}

Status check_no_walk_options(const WalkArguments& o) {
  for (const CLI::Option* option : o.options)
    if (option->count() > 0)
      return usage(option->get_name() + " needs a recording, allowed: TAKE.mkv in place of a list");
  return {};
}

bool is_take(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  char head[4] = {};
  stream.read(head, sizeof head);
  return std::string_view(head, sizeof head) == "\x1A\x45\xDF\xA3";  // EBML
}

Status check_output_is_no_walk(const std::filesystem::path& output, const std::filesystem::path& take,
                               const WalkArguments& o) {
  const auto poses = o.poses.empty() ? poses_beside(take) : std::filesystem::path(o.poses);
  if (const Status other = check_output_is_no_input(output, {poses}); !other || o.calibration.empty())
    return other;
  const std::filesystem::path folder(o.calibration);
  return check_output_is_no_input(output,
                                  {folder / "response.json", folder / "lens.json", folder / "flat.json"});
}

Result<std::shared_ptr<WalkTake>> open_walk(const std::filesystem::path& take, const WalkArguments& o,
                                            const FieldGrid& grid, int directions, bool speaks) {
  WalkOptions options;
  options.take = take;
  options.poses = o.poses;
  options.calibration = o.calibration;
  options.lag_s = o.lag_ms * 1e-3;
  options.track.most_gap_s = o.pose_gap_s;
  options.redundant = {o.redundant, o.spacing_m.value_or(grid.cell().minCoeff() / 2)};
  options.cells = directions;
  std::optional<Progress> bar;
  auto walk = WalkTake::open(options, [&](std::size_t done, std::size_t total) {
    if (!speaks) return;
    if (!bar) bar.emplace(total);
    bar->done(done);
  });
  bar.reset();
  if (walk && speaks)
    for (const std::string& line : (*walk)->remarks())
      std::fprintf(stderr, "lightwell: %s\n", printable(line).c_str());
  return walk;
}

void print_walk(const WalkTake& walk) {
  const WalkCounts& counts = walk.counts();
  std::printf("frames            %zu, %zu without a pose, %zu redundant, %zu kept\n", counts.frames,
              counts.outside + counts.in_gap + counts.in_jump, counts.redundant, counts.kept);
}

nlohmann::ordered_json walk_json(const WalkTake& walk, const WalkArguments& o) {
  const WalkCounts& counts = walk.counts();
  nlohmann::ordered_json spans = nlohmann::ordered_json::array();
  for (const FramesWithoutPose::Span& span : walk.without_pose().spans())
    spans.push_back({{"from_s", span.from_s}, {"to_s", span.to_s}, {"frames", span.frames}});
  return {{"poses", walk.poses_file().string()},
          {"calibration", walk.calibration_id()},
          {"lag_ms", o.lag_ms},
          {"frames", counts.frames},
          {"damaged", counts.damaged},
          {"without_pose",
           {{"outside", counts.outside},
            {"in_gap", counts.in_gap},
            {"in_jump", counts.in_jump},
            {"after_last", counts.after_last},
            {"spans", spans}}},
          {"pose_outliers", walk.track().outliers().size()},
          {"redundant", counts.redundant},
          {"kept", counts.kept},
          {"most_difference", walk.redundant().most_difference},
          {"most_spacing_m", walk.redundant().most_spacing_m},
          {"clipped_frames", counts.clipped_frames},
          {"most_clipped_pixels", counts.most_clipped_pixels}};
}

}  // namespace lightwell::cli
