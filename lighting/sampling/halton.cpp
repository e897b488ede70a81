// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/sampling/halton.h"

#include <cmath>

namespace lightwell {
namespace {

// A well-mixed 64 bit value of x (the finaliser of SplitMix64, Steele et al. 2014).
std::uint64_t mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

double unit_interval(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

}  // namespace

double radical_inverse(std::uint64_t i, unsigned base) {
  const double digit_step = 1.0 / base;
  double weight = digit_step;
  double result = 0;
  for (; i > 0; i /= base) {
    result += weight * static_cast<double>(i % base);
    weight *= digit_step;
  }
  return result;
}

std::vector<Vec2d> halton_points(std::size_t count, std::uint32_t seed) {
  const Vec2d shift =
      seed == 0 ? Vec2d(0, 0) : Vec2d(unit_interval(mix(seed)), unit_interval(mix(~std::uint64_t{seed})));
  std::vector<Vec2d> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2d p = Vec2d(radical_inverse(i + 1, 2), radical_inverse(i + 1, 3)) + shift;
    points[i] = p.array() - p.array().floor();
  }
  return points;
}

}  // namespace lightwell
