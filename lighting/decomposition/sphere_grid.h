// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lighting/vector.h"

namespace lightwell {

// Places of the unit sphere, numbered, in cubic cells of about 5°: those near a direction are found without
// looking at all.
class SphereGrid {
 public:
  SphereGrid() : cells_(kSide * kSide * kSide) {}

  void add(std::uint32_t number, const Vec3d& place) {
    cells_[cell_of(place)].push_back(number);
    ++size_;
  }
  void move(std::uint32_t number, const Vec3d& from, const Vec3d& to) {
    const std::size_t old_cell = cell_of(from);
    const std::size_t new_cell = cell_of(to);
    if (old_cell == new_cell) return;
    std::vector<std::uint32_t>& old_members = cells_[old_cell];
    *std::find(old_members.begin(), old_members.end(), number) = old_members.back();
    old_members.pop_back();
    cells_[new_cell].push_back(number);
  }

  // visit(number) for all places within the distance (chord) of the centre, and for some more; each once.
  template <class Visit>
  void near(const Vec3d& centre, double distance, const Visit& visit) const {
    std::size_t low[3];
    std::size_t high[3];
    std::size_t box = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = slot(centre[static_cast<Eigen::Index>(axis)] - distance);
      high[axis] = slot(centre[static_cast<Eigen::Index>(axis)] + distance);
      box *= high[axis] - low[axis] + 1;
    }
    if (box >= size_) {  // fewer places than cells: all of them
      for (std::uint32_t number = 0; number < size_; ++number) visit(number);
      return;
    }
    for (std::size_t x = low[0]; x <= high[0]; ++x)
      for (std::size_t y = low[1]; y <= high[1]; ++y)
        for (std::size_t z = low[2]; z <= high[2]; ++z)
          for (const std::uint32_t number : cells_[(x * kSide + y) * kSide + z]) visit(number);
  }

 private:
  static constexpr std::size_t kSide = 24;  // cells of 2/24, 4.8°, across the sphere

  static std::size_t slot(double coordinate) {
    const double place = (coordinate + 1) * (kSide / 2.0);
    return static_cast<std::size_t>(std::clamp(place, 0.0, kSide - 1.0));
  }
  static std::size_t cell_of(const Vec3d& place) {
    return (slot(place.x()) * kSide + slot(place.y())) * kSide + slot(place.z());
  }

  std::vector<std::vector<std::uint32_t>> cells_;
  std::size_t size_ = 0;  // numbers are 0 to size_ − 1
};

}  // namespace lightwell
