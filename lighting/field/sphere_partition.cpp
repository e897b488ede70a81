// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/sphere_partition.h"

#include <algorithm>
#include <cmath>

#include "lighting/direction.h"
#include "lighting/result.h"

namespace lightwell {
namespace {

constexpr int kFewestDirections = 3072;

}  // namespace

SpherePartition::SpherePartition(int cells) {
  verify_bug(cells >= 2, "a partition of the sphere has two cells or more");
  first_ = {0, 1};
  const double solid_angle = 4 * kPi / cells;
  const double cap_rad = std::acos(1 - solid_angle / (2 * kPi));
  const int collars =
      cells == 2 ? 0
                 : std::max(1, static_cast<int>(std::lround((kPi - 2 * cap_rad) / std::sqrt(solid_angle))));
  const double collar_rad = collars > 0 ? (kPi - 2 * cap_rad) / collars : 0;
  double rest = 0;  // what rounding has left to later collars
  for (int i = 0; i < collars; ++i) {
    const double ideal = 2 * kPi *
                         (std::cos(cap_rad + i * collar_rad) - std::cos(cap_rad + (i + 1) * collar_rad)) /
                         solid_angle;
    const int count = static_cast<int>(std::lround(ideal + rest));
    rest += ideal - count;
    first_.push_back(first_.back() + count);
  }
  first_.push_back(first_.back() + 1);
  verify_bug(first_.back() == cells, "the collars hold all cells");
}

double SpherePartition::cell_width_rad() const {
  return std::sqrt(cell_solid_angle_sr());
}

// A collar lies between the heights that leave its cells' area above and below: y = 1 − 2 first / cells.
int SpherePartition::cell_of(const Vec3d& direction) const {
  const double above = (1 - direction.y()) / 2 * cells();
  const auto next = std::upper_bound(first_.begin() + 1, first_.end() - 1, above,
                                     [](double value, int first) { return value < first; });
  const int count = *next - *(next - 1);
  const double turn = spherical_from_direction(direction).lambda_rad / (2 * kPi);
  return *(next - 1) + std::min(static_cast<int>(turn * count), count - 1);
}

Vec3d SpherePartition::centre(int cell) const {
  if (cell == 0) return Vec3d::UnitY();
  if (cell == cells() - 1) return -Vec3d::UnitY();
  const auto next = std::upper_bound(first_.begin(), first_.end(), cell);
  const int first = *(next - 1), count = *next - first;
  const double y = 1 - (first + 0.5 * count) * 2 / cells();
  const double horizontal = std::sqrt(std::max(0.0, 1 - y * y));
  const double lambda = 2 * kPi * (cell - first + 0.5) / count;
  return {horizontal * std::sin(lambda), y, horizontal * std::cos(lambda)};
}

int direction_count_for(const FieldGrid& grid) {
  constexpr double kCorridor = 4;
  Vec3d side = grid.high - grid.low;
  std::sort(side.begin(), side.end());
  const double path_cells = std::min(side[2], kCorridor * side[1]) / grid.cell().minCoeff();
  const double points = std::min<double>(grid.longest_side(), 1 + path_cells);
  return static_cast<int>(
      std::lround(std::clamp<double>(kPi * points * points, kFewestDirections, kMostFieldDirections)));
}

}  // namespace lightwell
