// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "lighting/vector.h"

namespace lightwell {

// Of every field that is written or read.
inline constexpr int kMostFieldSide = 4096;  // points along an axis
inline constexpr std::size_t kMostFieldPoints = std::size_t{512} * 512 * 512;

// Points of a field: a regular grid whose outermost points lie on the bounds. Point (i, j, k) is at
// low + cell · (i, j, k); points are stored with i running fastest.
struct FieldGrid {
  std::array<int, 3> size = {2, 2, 2};  // 2 or more along each axis
  Vec3d low = Vec3d::Zero();            // metres
  Vec3d high = Vec3d::Ones();           // above low

  [[nodiscard]] std::size_t points() const {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
           static_cast<std::size_t>(size[2]);
  }
  [[nodiscard]] Vec3d cell() const {
    return (high - low).cwiseQuotient(Vec3d(size[0] - 1, size[1] - 1, size[2] - 1));
  }
  [[nodiscard]] Vec3d position(int i, int j, int k) const {
    return low + cell().cwiseProduct(Vec3d(i, j, k));
  }
  // World to grid: (0, 0, 0) at low, 1 a cell.
  [[nodiscard]] Vec3d grid_from_world(const Vec3d& world) const {
    return (world - low).cwiseQuotient(cell());
  }
  [[nodiscard]] bool contains(const Vec3d& world) const {
    return (world.array() >= low.array()).all() && (world.array() <= high.array()).all();
  }
  bool operator==(const FieldGrid&) const = default;
  [[nodiscard]] int longest_side() const { return *std::max_element(size.begin(), size.end()); }
};

}  // namespace lightwell
