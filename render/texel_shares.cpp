// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/texel_shares.h"

#include <queue>

namespace lightwell::render {

std::vector<int> share_texels(std::span<const double> powers, int smallest, int largest, double texels) {
  std::vector<int> sides(powers.size(), smallest);
  double left = texels - static_cast<double>(powers.size()) * smallest * smallest;
  // What doubling saves, power / (2 side), for what it takes, 3 side².
  const auto gain = [&](std::size_t i) {
    const double side = sides[i];
    return powers[i] / (6 * side * side * side);
  };
  using Doubling = std::pair<double, std::size_t>;
  // Of equal gains the first light's.
  const auto later = [](const Doubling& a, const Doubling& b) {
    return a.first < b.first || (a.first == b.first && a.second > b.second);
  };
  std::priority_queue<Doubling, std::vector<Doubling>, decltype(later)> doublings(later);
  if (smallest < largest)
    for (std::size_t i = 0; i < powers.size(); ++i) doublings.emplace(gain(i), i);
  while (!doublings.empty()) {
    const std::size_t i = doublings.top().second;
    doublings.pop();
    const double takes = 3.0 * sides[i] * sides[i];
    if (takes > left) continue;
    left -= takes;
    sides[i] *= 2;
    if (sides[i] < largest) doublings.emplace(gain(i), i);
  }
  return sides;
}

}  // namespace lightwell::render
