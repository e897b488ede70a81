// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/tile_allocator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

namespace lightwell::render {
namespace {

struct Taken {
  TileAllocator::Corner at;
  int size;
};

bool overlap(const Taken& a, const Taken& b) {
  return a.at.x < b.at.x + b.size && b.at.x < a.at.x + a.size && a.at.y < b.at.y + b.size &&
         b.at.y < a.at.y + a.size;
}

TEST(TileAllocator, FromLargeToSmallAWholeIsFilledToTheLastUnit) {
  TileAllocator tiles;
  tiles.reset(16);
  std::vector<Taken> taken;
  const std::pair<int, int> sizes[] = {{8, 2}, {4, 6}, {2, 7}, {1, 4}};  // side, how many
  for (const auto& [size, count] : sizes)
    for (int i = 0; i < count; ++i)
      if (const auto at = tiles.take(size)) taken.push_back({*at, size});
  int area = 0;
  for (const Taken& t : taken) area += t.size * t.size;
  EXPECT_EQ(area, 256);
  EXPECT_FALSE(tiles.take(1));
}

TEST(TileAllocator, NothingOverlapsOrLeavesTheWholeWhateverComesAndGoes) {
  std::mt19937 random(3);
  for (const int side : {1, 2, 7, 16, 54}) {
    TileAllocator tiles;
    tiles.reset(side);
    std::vector<Taken> taken;
    for (int step = 0; step < 3000; ++step) {
      if (!taken.empty() && random() % 2 == 0) {
        const std::size_t which = random() % taken.size();
        tiles.give_back(taken[which].at, taken[which].size);
        taken.erase(taken.begin() + static_cast<std::ptrdiff_t>(which));
        continue;
      }
      const int size = 1 << (random() % 4);
      const auto at = tiles.take(size);
      if (!at) continue;
      const Taken fresh{*at, size};
      ASSERT_TRUE(at->x >= 0 && at->y >= 0 && at->x + size <= side && at->y + size <= side);
      ASSERT_TRUE(
          std::none_of(taken.begin(), taken.end(), [&](const Taken& t) { return overlap(t, fresh); }));
      taken.push_back(fresh);
    }
    // All of it comes together again.
    for (const Taken& t : taken) tiles.give_back(t.at, t.size);
    int units = 0;
    while (tiles.take(1)) ++units;
    EXPECT_EQ(units, side * side);
  }
}

TEST(TileAllocator, GivenBackTheWholeIsOneAgain) {
  TileAllocator tiles;
  tiles.reset(8);
  std::vector<TileAllocator::Corner> corners;
  while (const auto at = tiles.take(1)) corners.push_back(*at);
  ASSERT_EQ(corners.size(), 64u);
  EXPECT_FALSE(tiles.take(8));
  for (const auto& at : corners) tiles.give_back(at, 1);
  EXPECT_TRUE(tiles.take(8));
}

}  // namespace
}  // namespace lightwell::render
