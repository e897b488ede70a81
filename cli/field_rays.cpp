// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/field_rays.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace lightwell::cli {
namespace {

constexpr std::size_t kNamed = 3;     // of a line
constexpr std::size_t kListed = 100;  // in JSON
// Half of the light: sharp edges of beams on a stage bring it to .4 at a tenth of a metre a cell.
constexpr double kMostDifference = 0.5;

}  // namespace

std::vector<std::string> remarks_on_rays(const ProbeTake& take, const FieldBuild& build) {
  std::vector<std::string> lines;
  char text[240];
  if (!build.doubtful.empty()) {
    std::string line = "rays of " + std::to_string(build.doubtful.size()) + " of " +
                       std::to_string(take.positions.size()) + " probes contradict those around them: ";
    for (std::size_t i = 0; i < std::min(kNamed, build.doubtful.size()); ++i) {
      const auto [probe, share] = build.doubtful[i];
      const Vec3d& at = take.positions[probe];
      std::snprintf(text, sizeof text, " at (%.2f, %.2f, %.2f) in %.0f %% of its directions", at.x(), at.y(),
                    at.z(), 100 * share);
      line += (i > 0 ? ", " : "") + take.name(probe) + text;
    }
    if (build.doubtful.size() > kNamed) line += ", …";
    lines.push_back(line + "; something stood before them, a lamp was moved, or their place is another");
  }
  if (build.close_difference > kMostDifference) {
    std::snprintf(text, sizeof text,
                  "rays that pass within a quarter of a cell of each other differ by %.0f %% of their light: "
                  "light that "
                  "changed with time, places that are not right, or edges finer than the grid",
                  100 * build.close_difference);
    lines.emplace_back(text);
  }
  return lines;
}

nlohmann::ordered_json rays_json(const ProbeTake& take, const FieldBuild& build) {
  nlohmann::ordered_json worst = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < std::min(kListed, build.doubtful.size()); ++i) {
    const auto [probe, share] = build.doubtful[i];
    const Vec3d& at = take.positions[probe];
    worst.push_back({{"probe", take.name(probe)}, {"at", {at.x(), at.y(), at.z()}}, {"share", share}});
  }
  return {{"close_difference", build.close_difference},
          {"inconsistent_probes", build.doubtful.size()},
          {"inconsistent", worst}};
}

}  // namespace lightwell::cli
