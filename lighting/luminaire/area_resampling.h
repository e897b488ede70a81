// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "lighting/vector.h"

namespace lightwell {

// Pixels of any convex shape, each even over its area, onto the pixels of a grid by the area that they share: what they
// hold times their area is kept where the grid covers them, and pixels that tile the plane leave no seam.
class AreaResampling {
 public:
  // Column along x from low.x(), row along y from low.y(); high: above low, the outer edges.
  AreaResampling(const std::array<int, 2>& pixels, const Vec2d& low, const Vec2d& high);

  using Quad = std::array<Vec2d, 4>;  // corners in turn, either way round
  // The area that a pixel shares with the grid; nothing is added.
  [[nodiscard]] double shared_area(const Quad& corners) const;
  double add(const Quad& corners, const Rgbd& value);  // the area shared

  // The mean over a pixel of the grid; 0 where nothing was added.
  [[nodiscard]] Rgbd mean(int column, int row) const;
  // The part of a pixel of the grid that was added to.
  [[nodiscard]] double covered(int column, int row) const;
  // By what a mean differs from the value at its pixel's middle, to second order: the mean variance, along x and y in
  // pixels of the grid, of the places that added pixels took their light from.
  [[nodiscard]] Vec2d blur_variance() const;

 private:
  [[nodiscard]] std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(pixels_[0]) +
           static_cast<std::size_t>(column);
  }
  template <class F>
  void for_each_shared(const Quad& corners, const F& take) const;

  std::array<int, 2> pixels_;
  Vec2d low_, pixel_;
  std::vector<Rgbd> sums_;
  std::vector<double> areas_;  // in pixels of the grid
  Vec2d variances_ = Vec2d::Zero();
  double area_ = 0;
};

}  // namespace lightwell
