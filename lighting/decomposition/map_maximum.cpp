// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/map_maximum.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace lightwell {
namespace {

// Levels until one cell holds `count`.
std::size_t levels_for(int count) {
  return static_cast<std::size_t>(std::bit_width(static_cast<unsigned>(count) - 1u)) + 1;
}

std::size_t level_of(int extent) {
  return static_cast<std::size_t>(std::bit_width(static_cast<unsigned>(extent))) - 1;
}

}  // namespace

MapMaximum::MapMaximum(const PolarGrid& grid, std::vector<double> values)
    : grid_(grid), sector_levels_(levels_for(grid.sectors)) {
  const std::size_t ring_levels = levels_for(grid.rings);
  auto rows = static_cast<std::size_t>(grid.rings);
  for (std::size_t i = 0; i < ring_levels; ++i) {
    if (i == 0) {
      levels_.push_back({static_cast<std::size_t>(grid.sectors), std::move(values)});
    } else {
      const Level& finer = levels_[(i - 1) * sector_levels_];
      Level level{finer.columns, std::vector<double>((rows + 1) / 2 * finer.columns, 0)};
      for (std::size_t k = 0; k < finer.most.size(); ++k) {
        double& most = level.most[k / finer.columns / 2 * finer.columns + k % finer.columns];
        most = std::max(most, finer.most[k]);
      }
      rows = (rows + 1) / 2;
      levels_.push_back(std::move(level));
    }
    for (std::size_t j = 1; j < sector_levels_; ++j) {
      const Level& finer = levels_.back();
      const std::size_t columns = (finer.columns + 1) / 2;
      Level level{columns, std::vector<double>(rows * columns, 0)};
      for (std::size_t k = 0; k < finer.most.size(); ++k) {
        double& most = level.most[k / finer.columns * columns + k % finer.columns / 2];
        most = std::max(most, finer.most[k]);
      }
      levels_.push_back(std::move(level));
    }
  }
}

double MapMaximum::value(int ring, int sector) const {
  return levels_[0]
      .most[static_cast<std::size_t>(ring) * levels_[0].columns + static_cast<std::size_t>(sector)];
}

double MapMaximum::bound(int ring0, int ring1, int sector0, int sectors) const {
  if (sectors >= grid_.sectors) return in_rectangle(ring0, ring1, 0, grid_.sectors - 1);
  const int last = sector0 + sectors - 1;
  if (last < grid_.sectors) return in_rectangle(ring0, ring1, sector0, last);
  return std::max(in_rectangle(ring0, ring1, sector0, grid_.sectors - 1),
                  in_rectangle(ring0, ring1, 0, last - grid_.sectors));
}

double MapMaximum::in_rectangle(int ring0, int ring1, int sector0, int sector1) const {
  const std::size_t i = level_of(ring1 - ring0 + 1);
  const std::size_t j = level_of(sector1 - sector0 + 1);
  const Level& level = levels_[i * sector_levels_ + j];
  double most = 0;
  for (std::size_t row = static_cast<std::size_t>(ring0) >> i; row <= static_cast<std::size_t>(ring1) >> i;
       ++row)
    for (std::size_t column = static_cast<std::size_t>(sector0) >> j;
         column <= static_cast<std::size_t>(sector1) >> j; ++column)
      most = std::max(most, level.most[row * level.columns + column]);
  return most;
}

}  // namespace lightwell
