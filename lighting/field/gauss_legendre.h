// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace lightwell {

// Σ weights · f(nodes) is ∫₋₁¹ f exactly for polynomials to degree 2 · count − 1. Nodes increase.
// source: Golub and Welsch 1969, "Calculation of Gauss quadrature rules"
struct GaussLegendre {
  Eigen::VectorXd nodes, weights;
};
GaussLegendre gauss_legendre(int count);

}  // namespace lightwell
