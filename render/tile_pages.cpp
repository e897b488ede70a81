// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/tile_pages.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lightwell::render {
namespace {

// order: from the largest to the smallest, which leaves the fewest gaps
std::optional<Packing> pack_into(TilePages pages, std::span<const int> sizes,
                                 std::span<const std::size_t> order) {
  Packing packing{std::move(pages), std::vector<TilePages::Place>(sizes.size())};
  for (const std::size_t i : order) {
    const auto place = packing.pages.take(sizes[i]);
    if (!place) return std::nullopt;
    packing.places[i] = *place;
  }
  return packing;
}

}  // namespace

TilePages::TilePages(int pages, int side) : side_(side), pages_(static_cast<std::size_t>(pages)) {
  for (TileAllocator& page : pages_) page.reset(side);
}

std::optional<TilePages::Place> TilePages::take(int size) {
  for (std::size_t page = 0; page < pages_.size(); ++page)
    if (const auto at = pages_[page].take(size)) return Place{static_cast<int>(page), *at};
  return std::nullopt;
}

void TilePages::give_back(const Place& place, int size) {
  pages_[static_cast<std::size_t>(place.page)].give_back(place.at, size);
}

std::optional<Packing> pack(std::span<const int> sizes, const TilePages& there, int most_pages, int most_side,
                            int step) {
  std::vector<std::size_t> order(sizes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return sizes[a] > sizes[b]; });
  double area = 0;
  for (const int size : sizes) area += static_cast<double>(size) * size;
  const auto full_pages = static_cast<int>(std::ceil(area / most_side / most_side));
  for (int pages = std::max({1, full_pages, there.count()}); pages <= most_pages; ++pages) {
    const auto least = static_cast<int>(std::ceil(std::sqrt(area / pages)));
    int side = std::max({(least + step - 1) / step * step, there.side(), 1});
    for (side = std::min(side, most_side);; side = std::min(side + step, most_side)) {
      if (auto packing = pack_into(TilePages(pages, side), sizes, order)) return packing;
      if (side == most_side) break;
    }
  }
  return std::nullopt;
}

}  // namespace lightwell::render
