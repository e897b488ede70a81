// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/gauss_legendre.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace lightwell {

GaussLegendre gauss_legendre(int count) {
  Eigen::MatrixXd jacobi = Eigen::MatrixXd::Zero(count, count);
  for (int i = 1; i < count; ++i) jacobi(i, i - 1) = jacobi(i - 1, i) = i / std::sqrt(4.0 * i * i - 1);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(jacobi);
  return {solver.eigenvalues(), 2 * solver.eigenvectors().row(0).transpose().cwiseAbs2()};
}

}  // namespace lightwell
