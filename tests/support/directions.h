// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "lighting/vector.h"

namespace lightwell::test {

// Evenly over the sphere, or over its upper half; the same for the same seed. Coordinates are floats' values.
inline std::vector<Vec3d> random_directions(int count, unsigned seed, bool upper = false) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<Vec3d> d;
  for (int i = 0; i < count; ++i) {
    Vec3d v(normal(generator), normal(generator), normal(generator));
    if (upper) v.y() = std::abs(v.y());
    d.push_back(v.normalized().cast<float>().cast<double>());
  }
  return d;
}

// Non-negative, of four decades, some zero; they sum to 1.
inline std::vector<double> random_powers(int count, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<double> w;
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += w.emplace_back(i % 7 == 3 ? 0 : std::pow(uniform(generator), 4));
  for (double& v : w) v /= sum;
  return w;
}

}  // namespace lightwell::test
