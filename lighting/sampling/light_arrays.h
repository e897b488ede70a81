// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace lightwell {

// Directional lights as a structure of arrays, for the loops over all of them. Light i is the same light in
// every frame. Directions are unit, illuminance in lux (lighting/light_set.h).
struct LightArrays {
  std::vector<float> x, y, z;
  std::vector<float> r, g, b;

  LightArrays() = default;
  explicit LightArrays(std::size_t count)
      : x(count, 0), y(count, 1), z(count, 0), r(count, 0), g(count, 0), b(count, 0) {}
  [[nodiscard]] std::size_t size() const { return x.size(); }
};

// In double, over four running sums: a single one would wait for itself.
inline double sum_of(std::span<const float> values) noexcept {
  double a = 0, b = 0, c = 0, d = 0;
  std::size_t i = 0;
  for (; i + 4 <= values.size(); i += 4) {
    a += static_cast<double>(values[i]);
    b += static_cast<double>(values[i + 1]);
    c += static_cast<double>(values[i + 2]);
    d += static_cast<double>(values[i + 3]);
  }
  for (; i < values.size(); ++i) a += static_cast<double>(values[i]);
  return (a + b) + (c + d);
}

}  // namespace lightwell
