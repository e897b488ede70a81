// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lighting/harmonics.h"

namespace lightwell {

// Turns spherical harmonics: with D = HarmonicRotation(R, degree), D · L has the coefficients of the radiance that comes
// from R d where L's comes from d. Exact to rounding, by a quadrature that is exact for products of two of them.
class HarmonicRotation {
 public:
  HarmonicRotation(const Eigen::Matrix3d& rotation, int degree);  // degree up to kMostDegree

  // coefficients: [harmonic_count(degree)] rows, any number of columns.
  [[nodiscard]] Eigen::MatrixXd apply(const Eigen::MatrixXd& coefficients) const;
  // [2l + 1][2l + 1]: band l, orthogonal.
  [[nodiscard]] const Eigen::MatrixXd& band(int l) const { return bands_[static_cast<std::size_t>(l)]; }

 private:
  std::vector<Eigen::MatrixXd> bands_;
};

}  // namespace lightwell
