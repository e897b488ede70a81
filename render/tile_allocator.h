// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

namespace lightwell::render {

// Squares within a square, their sides powers of two: a buddy system in which four equal neighbours come together when all
// are free. Of a whole whose side is a power of two, squares taken from the largest to the smallest leave no gap.
class TileAllocator {
 public:
  struct Corner {
    int x, y;
  };

  // All free.
  void reset(int side);
  [[nodiscard]] int side() const { return side_; }
  // size: a power of two. nullopt: no square of this size is free.
  std::optional<Corner> take(int size);
  // What was taken, with its size.
  void give_back(Corner at, int size);

 private:
  [[nodiscard]] std::vector<Corner>& free_of(int size);
  void fill(Corner at, int size);

  int side_ = 0;
  std::vector<std::vector<Corner>> free_;  // by the size's logarithm
};

}  // namespace lightwell::render
