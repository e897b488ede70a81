// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "lighting/vector.h"

namespace lightwell {

// Cubic convolution, third order: weights of the neighbours at −1, 0, 1 and 2 for a place x between 0 and 1.
// source: Keys 1981, a = −½
std::array<double, 4> cubic_weights(double x) noexcept;

// The two planes between which a lamp's light is described, in its frame: it shines toward −Z, the sampling plane is
// z = 0 just before it, the measurement plane z = −distance_m. A ray meets them in (u, v) and (s, t), both (x, y).
struct LampPlanes {
  // Positions on the sampling plane: a square grid.
  std::array<int, 2> positions = {1, 1};  // along u, v
  double spacing_m = 0.01;
  Vec2d first_m = Vec2d::Zero();  // (u, v) of the first
  // Pixels on the measurement plane, each even over its area; column along s, row along t.
  double distance_m = 0.1;
  std::array<int, 2> pixels = {1, 1};
  Vec2d low_m = Vec2d::Constant(-0.1), high_m = Vec2d::Constant(0.1);  // outer edges

  [[nodiscard]] std::size_t images() const {
    return static_cast<std::size_t>(positions[0]) * static_cast<std::size_t>(positions[1]);
  }
  [[nodiscard]] std::size_t image_size() const {
    return static_cast<std::size_t>(pixels[0]) * static_cast<std::size_t>(pixels[1]);
  }
  [[nodiscard]] std::size_t image(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(positions[0]) + static_cast<std::size_t>(u);
  }
  [[nodiscard]] Vec2d position(int u, int v) const { return first_m + spacing_m * Vec2d(u, v); }
  [[nodiscard]] Vec2d pixel_m() const { return (high_m - low_m).cwiseQuotient(Vec2d(pixels[0], pixels[1])); }
  [[nodiscard]] Vec2d pixel_centre(int s, int t) const {
    return low_m + pixel_m().cwiseProduct(Vec2d(s + 0.5, t + 0.5));
  }
};

// Images of a lamp: [v][u][t][s].
struct LampImages {
  LampPlanes planes;
  std::vector<Rgb> values;

  [[nodiscard]] Rgb* image(int u, int v) { return values.data() + planes.image(u, v) * planes.image_size(); }
  [[nodiscard]] const Rgb* image(int u, int v) const {
    return values.data() + planes.image(u, v) * planes.image_size();
  }
  // By cubic convolution between pixel centres; 0 outside the pixels.
  [[nodiscard]] Rgbd at(int u, int v, const Vec2d& measurement) const;
};

}  // namespace lightwell
