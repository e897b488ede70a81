// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/luminaire/rig_positions.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>

namespace lightwell::calibration {
namespace {

constexpr double kMostDeviation = 0.02;  // spacings: moves a filter's middle by no more than a stage is off
constexpr double kMostMissing = 0.1;     // of the grid

Error bad(const std::string& message) {
  return {ErrorKind::bad_input, message};
}

Status check_on_grid(const Rig& rig, const PositionGrid& grid) {
  for (std::size_t i = 0; i < rig.pictures.size(); ++i) {
    if (grid.deviation_m[i] <= kMostDeviation * rig.spacing_m) continue;
    const Vec2d stated = rig.pictures[i].position_m * (rig.moves == Rig::Moves::lamp ? -1 : 1);
    char what[200];
    std::snprintf(what, sizeof what,
                  ": x,y = %g,%g: %.3g m off the grid of %g m, allowed: up to %.3g m, %g of the spacing",
                  stated.x(), stated.y(), grid.deviation_m[i], rig.spacing_m, kMostDeviation * rig.spacing_m,
                  kMostDeviation);
    return bad(rig.pictures[i].place + what);
  }
  return {};
}

// The first picture of each part at each position.
using Taken = std::array<const Rig::Picture*, 3>;

Status check_parts(const std::vector<Taken>& taken) {
  for (const Taken& parts : taken) {
    const auto* whole = parts[static_cast<std::size_t>(Rig::Part::whole)];
    const auto* positive = parts[static_cast<std::size_t>(Rig::Part::positive)];
    const auto* negative = parts[static_cast<std::size_t>(Rig::Part::negative)];
    if (whole != nullptr && (positive != nullptr || negative != nullptr))
      return bad(whole->place + ": the position has a part of the filter as well as the whole");
    if ((positive == nullptr) != (negative == nullptr))
      return bad((positive != nullptr ? positive : negative)->place + ": the position has no " +
                 (positive != nullptr ? "negative" : "positive") + " part");
  }
  return {};
}

}  // namespace

Result<RigPositions> rig_positions(const Rig& rig, const std::filesystem::path& folder) {
  std::vector<Vec2d> places;
  for (const Rig::Picture& picture : rig.pictures) places.push_back(picture.position_m);
  RigPositions out;
  out.grid = position_grid(places, rig.spacing_m);
  if (const Status on = check_on_grid(rig, out.grid); !on) return on.error();
  out.largest_deviation =
      *std::max_element(out.grid.deviation_m.begin(), out.grid.deviation_m.end()) / rig.spacing_m;
  const std::string list = (folder / "positions.csv").string();
  const std::int64_t cells = std::int64_t{out.grid.positions[0]} * out.grid.positions[1];
  const auto too_many = [&](std::int64_t measured) {
    return bad(list + ": " + std::to_string(measured) + " positions of a grid of " +
               std::to_string(out.grid.positions[0]) + "x" + std::to_string(out.grid.positions[1]) +
               ", allowed: a tenth missing at most");
  };
  const auto least = [&](std::int64_t count) {
    return static_cast<double>(count) >= (1 - kMostMissing) * static_cast<double>(cells);
  };
  if (!least(static_cast<std::int64_t>(places.size())))
    return too_many(static_cast<std::int64_t>(places.size()));
  std::vector<Taken> taken(static_cast<std::size_t>(cells), Taken{});
  for (std::size_t i = 0; i < rig.pictures.size(); ++i) {
    const auto [u, v] = out.grid.at[i];
    const std::size_t cell = static_cast<std::size_t>(v) * static_cast<std::size_t>(out.grid.positions[0]) +
                             static_cast<std::size_t>(u);
    const Rig::Picture& picture = rig.pictures[i];
    const Rig::Picture*& slot = taken[cell][static_cast<std::size_t>(picture.part)];
    if (slot != nullptr) return bad(picture.place + ": the same position and part as in " + slot->place);
    slot = &picture;
  }
  if (const Status whole = check_parts(taken); !whole) return whole.error();
  for (const Taken& parts : taken)
    out.measured.push_back(
        std::any_of(parts.begin(), parts.end(), [](const auto* p) { return p != nullptr; }));
  const auto measured = std::count(out.measured.begin(), out.measured.end(), true);
  if (!least(measured)) return too_many(measured);
  return out;
}

}  // namespace lightwell::calibration
