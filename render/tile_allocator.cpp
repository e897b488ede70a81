// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/tile_allocator.h"

#include <algorithm>
#include <bit>

namespace lightwell::render {

std::vector<TileAllocator::Corner>& TileAllocator::free_of(int size) {
  return free_[static_cast<std::size_t>(std::countr_zero(static_cast<unsigned>(size)))];
}

void TileAllocator::reset(int side) {
  side_ = side;
  const unsigned around = std::bit_ceil(static_cast<unsigned>(side));
  free_.assign(static_cast<std::size_t>(std::countr_zero(around)) + 1, {});
  fill({0, 0}, static_cast<int>(around));
}

// The largest squares that lie inside.
void TileAllocator::fill(Corner at, int size) {
  if (at.x >= side_ || at.y >= side_) return;
  if (at.x + size <= side_ && at.y + size <= side_) {
    free_of(size).push_back(at);
    return;
  }
  const int half = size / 2;
  for (const Corner& part :
       {Corner{at.x + half, at.y + half}, Corner{at.x, at.y + half}, Corner{at.x + half, at.y}, at})
    fill(part, half);
}

std::optional<TileAllocator::Corner> TileAllocator::take(int size) {
  const int around = 1 << (free_.size() - 1);
  int found = size;
  while (found <= around && free_of(found).empty()) found *= 2;
  if (found > around) return std::nullopt;
  const Corner at = free_of(found).back();
  free_of(found).pop_back();
  for (; found > size; found /= 2) {
    const int half = found / 2;
    for (const Corner& rest :
         {Corner{at.x + half, at.y + half}, Corner{at.x, at.y + half}, Corner{at.x + half, at.y}})
      free_of(half).push_back(rest);
  }
  return at;
}

void TileAllocator::give_back(Corner at, int size) {
  for (; 2 * size <= side_; size *= 2) {
    const Corner whole{at.x / (2 * size) * (2 * size), at.y / (2 * size) * (2 * size)};
    std::vector<Corner>& free = free_of(size);
    const auto of_whole = [&](const Corner& c) {
      return c.x / (2 * size) * (2 * size) == whole.x && c.y / (2 * size) * (2 * size) == whole.y;
    };
    if (std::count_if(free.begin(), free.end(), of_whole) < 3) break;
    std::erase_if(free, of_whole);
    at = whole;
  }
  free_of(size).push_back(at);
}

}  // namespace lightwell::render
