// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace lightwell {

inline constexpr int kMostUnknowns = 17;

using SmallMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMostUnknowns, kMostUnknowns>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMostUnknowns, 1>;

struct NonnegativeSolution {
  SmallVector x;
  unsigned positive = 0;  // bit j: x_j is free, the others are held at 0
  double decrease = 0;    // of ½‖A x − y‖² from x = 0: ½ rightᵀ x
};

// The x ≥ 0 that minimises ½ xᵀ gram x − rightᵀ x, with gram = AᵀA and right = Aᵀy: least squares on the normal
// equations. A column that depends on free ones, as of two lights in one place, stays at 0. Allocates nothing.
// gram: symmetric, up to 17 × 17, diagonal > 0
// source: Bro, de Jong 1997, "A fast non-negativity-constrained least squares algorithm"
NonnegativeSolution solve_nonnegative(const SmallMatrix& gram, const SmallVector& right,
                                      unsigned first_guess = 0);

}  // namespace lightwell
