// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lighting/field/field_grid.h"

namespace lightwell {

// For one direction all rays are parallel: a field is two-dimensional across it. The plane is the grid's own middle slice
// across the axis that the direction runs along most, so that every row of grid points lies on the plane's pixels but for
// one shift (as in Lacroute and Levoy 1994, "Fast volume rendering using a shear-warp factorization"): no grid point needs
// a search. Lengths are in cells: an oblong cell makes the kernels as oblong.
class ShearPlane {
 public:
  // direction: of any length, not zero; pixels_a_cell: 1 or more.
  ShearPlane(const FieldGrid& grid, const Vec3d& direction, int pixels_a_cell);

  [[nodiscard]] int width() const { return size_[0]; }   // pixels along axes()[0]
  [[nodiscard]] int height() const { return size_[1]; }  // along axes()[1]
  [[nodiscard]] int pixels_a_cell() const { return pixels_a_cell_; }
  // The two axes of the plane, and that across it.
  [[nodiscard]] const std::array<int, 3>& axes() const { return axes_; }
  // Where the ray through a grid position meets the plane, in pixels.
  [[nodiscard]] Vec2d pixel_of(const Vec3d& grid_position) const;
  // Pixels to lengths across the direction in cells: |across(a) − across(b)| is the distance of two rays.
  [[nodiscard]] Vec2d across(const Vec2d& pixel) const { return across_from_pixel_ * pixel; }
  // The pixels that look-ups at grid points read: of each row the first column and one past the last. What lies outside
  // belongs to no grid point. Sized to height().
  void read_columns(std::vector<std::array<int, 2>>& rows) const;
  // By how many pixels the grid points of a slice across axes()[2] lie beside those of slice 0 … in pixels of point (0, 0).
  [[nodiscard]] Vec2d slice_origin(int slice) const;

 private:
  std::array<int, 3> axes_;
  std::array<int, 2> size_, points_;
  int slices_;
  int pixels_a_cell_;
  double middle_;
  Vec2d slope_, start_;
  Eigen::Matrix2d across_from_pixel_;
};

// What one direction holds across the plane: radiance, and 1 where a measured ray passes near (else 0).
struct PlaneImage {
  int width = 0, height = 0;
  static constexpr std::size_t kBehind =
      16;                       // numbers that those who read many at once may read behind the last
  std::vector<float> channels;  // [4][height][width]: R, G, B, known; then those

  void resize(int w, int h);
  [[nodiscard]] std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  [[nodiscard]] float* channel(int c) { return channels.data() + static_cast<std::size_t>(c) * pixels(); }
  [[nodiscard]] const float* channel(int c) const {
    return channels.data() + static_cast<std::size_t>(c) * pixels();
  }
};

// A measured ray counts as near where it passes within the paper's kernel, 3 cells across.
inline constexpr double kNearCells = 1.5;

// A ray of one direction: where it meets the plane, in cells across the direction, and its radiance.
struct PlaneSample {
  Eigen::Vector2f at;
  Eigen::Array3f radiance;
};

}  // namespace lightwell
