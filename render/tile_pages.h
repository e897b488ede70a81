// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "render/tile_allocator.h"

namespace lightwell::render {

// Squares within several equal squares, the pages.
class TilePages {
 public:
  struct Place {
    int page = 0;
    TileAllocator::Corner at{0, 0};
  };

  TilePages() = default;
  TilePages(int pages, int side);

  [[nodiscard]] int count() const { return static_cast<int>(pages_.size()); }
  [[nodiscard]] int side() const { return side_; }
  // size: a power of two. nullopt: no square of this size is free on any page.
  std::optional<Place> take(int size);
  void give_back(const Place& place, int size);

 private:
  int side_ = 0;
  std::vector<TileAllocator> pages_;
};

// The fewest pages, of the least side, that hold squares of these sizes: no smaller than those that are there, at most so
// many and so large. step: of the pages' side. Its places are in the order of the sizes. Empty where they do not fit.
struct Packing {
  TilePages pages;
  std::vector<TilePages::Place> places;
};
std::optional<Packing> pack(std::span<const int> sizes, const TilePages& there, int most_pages, int most_side,
                            int step);

}  // namespace lightwell::render
