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

// What the pixels of a lamp's images stand for.
enum class LampMap {
  plane,  // points (s, t) of the measurement plane, distance_m below the sampling plane
  hemisphere,  // directions below the sampling plane: the disc of equal areas as a square, −1 to 1 (Shirley, Chiu 1997)
};

// How a lamp's light is described, in its frame: it shines toward −Z, the sampling plane lies across just before it. A ray
// meets it in (u, v), and the measurement plane in (s, t), both (x, y).
struct LampPlanes {
  // Positions on the sampling plane: a square grid.
  std::array<int, 2> positions = {1, 1};  // along u, v
  double spacing_m = 0.01;
  Vec2d first_m = Vec2d::Zero();  // (u, v) of the first
  double z_m = 0;                 // of the sampling plane
  LampMap map = LampMap::plane;
  // Pixels of the map, each even over its area; column along s, row along t.
  double distance_m = 0.1;  // of the measurement plane
  std::array<int, 2> pixels = {1, 1};
  Vec2d low_m = Vec2d::Constant(-0.1), high_m = Vec2d::Constant(0.1);  // outer edges; ±1 of a hemisphere

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
  [[nodiscard]] Vec3d place(const Vec2d& sampling) const { return {sampling.x(), sampling.y(), z_m}; }
  [[nodiscard]] Vec2d pixel_m() const { return (high_m - low_m).cwiseQuotient(Vec2d(pixels[0], pixels[1])); }
  [[nodiscard]] Vec2d pixel_centre(int s, int t) const {
    return low_m + pixel_m().cwiseProduct(Vec2d(s + 0.5, t + 0.5));
  }
  // Where on the map a ray from (u, v) lies; way: to any point of it below the sampling plane.
  [[nodiscard]] Vec2d on_map(const Vec2d& sampling, const Vec3d& way) const;
  // Of a pixel, as seen from (u, v) of the sampling plane.
  [[nodiscard]] double pixel_solid_angle_sr(const Vec2d& sampling, int s, int t) const;
};

// Directions below the sampling plane (unit, z ≤ 0) to the square of −1 to 1, equal areas to equal solid angles.
Vec2d square_from_direction(const Vec3d& direction);
Vec3d direction_from_square(const Vec2d& place);

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
