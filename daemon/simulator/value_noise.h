// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

namespace lightwell::simulator {

// SplitMix64's finaliser (Steele, Lea and Flood 2014): a good hash of one word, the same everywhere.
constexpr std::uint64_t mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

// Smooth noise in [0, 1]: random values on the integer lattice, interpolated with zero slope at the lattice
// points.
inline double value_noise(double x, double y) {
  const double fx = std::floor(x), fy = std::floor(y);
  const auto lattice = [&](double i, double j) {
    const auto a = static_cast<std::uint64_t>(static_cast<std::int64_t>(i));
    const auto b = static_cast<std::uint64_t>(static_cast<std::int64_t>(j));
    return static_cast<double>(mix(a * 0x632be59bd9b4e019u ^ mix(b)) >> 11) * 0x1p-53;
  };
  const auto ease = [](double t) { return t * t * (3 - 2 * t); };
  const double u = ease(x - fx), v = ease(y - fy);
  const double top = std::lerp(lattice(fx, fy), lattice(fx + 1, fy), u);
  const double bottom = std::lerp(lattice(fx, fy + 1), lattice(fx + 1, fy + 1), u);
  return std::lerp(top, bottom, v);
}

// Octaves of halving size and strength, normalised to [0, 1].
inline double fractal_noise(double x, double y, int octaves) {
  double sum = 0, strength = 1, total = 0;
  for (int i = 0; i < octaves; ++i) {
    sum += strength * value_noise(x, y);
    total += strength;
    strength /= 2;
    x = 2 * x + 17.3;  // shifted, so that the octaves' lattices do not meet at the origin
    y = 2 * y - 5.1;
  }
  return sum / total;
}

}  // namespace lightwell::simulator
