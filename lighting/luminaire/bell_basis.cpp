// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/luminaire/bell_basis.h"

#include <Eigen/LU>
#include <cmath>

namespace lightwell {
namespace {

// ∫ Φ(x) Φ(x − t) dx at t = 0, ½, 1, 1½ (the piecewise integrals of the bell, by hand); 0 from 2 on.
constexpr std::array<double, 4> kOverlaps = {23.0 / 30, 119.0 / 240, 7.0 / 60, 1.0 / 240};
double overlap(int half_steps) {
  const auto i = static_cast<std::size_t>(std::abs(half_steps));
  return i < kOverlaps.size() ? kOverlaps[i] : 0;
}

constexpr int kCanonicalTerms = 20;  // α^20 is 7e-17

struct Canonical {
  double alpha, scale;
};
// Of the inverse of the Gram matrix, tridiagonal with 23/30 and 7/60.
Canonical canonical() {
  const double g0 = overlap(0), g1 = overlap(2);
  const double alpha = (-g0 + std::sqrt(g0 * g0 - 4 * g1 * g1)) / (2 * g1);
  return {alpha, 1 / (g0 + 2 * g1 * alpha)};
}

// c_0, c_1, c_2: biorthogonal to the bells at 0, 1 and 2, and so, by symmetry and reach, to all.
Eigen::Vector3d finite_coefficients() {
  Eigen::Matrix3d rows;
  for (int n = 0; n < 3; ++n) {
    rows(n, 0) = overlap(2 * n);
    for (int k = 1; k < 3; ++k) rows(n, k) = overlap(2 * n - k) + overlap(2 * n + k);
  }
  return rows.inverse() * Eigen::Vector3d::UnitX();
}

}  // namespace

double bell(double x) noexcept {
  const double a = std::abs(x);
  if (a <= 0.5) return 1 - 2 * x * x;
  return a < 1 ? 2 * (1 - a) * (1 - a) : 0;
}

double bell_dual(BellDual dual, double x) noexcept {
  double sum = 0;
  if (dual == BellDual::canonical) {
    static const Canonical kCanonical = canonical();
    const int first = static_cast<int>(std::floor(x));  // bells that reach x: there and at the next
    for (const int k : {first, first + 1})
      if (std::abs(k) <= kCanonicalTerms)
        sum += kCanonical.scale * std::pow(kCanonical.alpha, std::abs(k)) * bell(x - k);
    return sum;
  }
  static const Eigen::Vector3d kFinite = finite_coefficients();
  for (int k = -2; k <= 2; ++k) sum += kFinite[std::abs(k)] * bell(x - 0.5 * k);
  return sum;
}

double bell_dual_reach(BellDual dual) noexcept {
  return dual == BellDual::canonical ? kCanonicalTerms + kBellReach : 1 + kBellReach;
}

double bell_dual_noise(BellDual dual) noexcept {
  if (dual == BellDual::canonical) return canonical().scale;  // the inverse Gram matrix's diagonal
  const Eigen::Vector3d c = finite_coefficients();
  double sum = 0;
  for (int i = -2; i <= 2; ++i)
    for (int j = -2; j <= 2; ++j) sum += c[std::abs(i)] * c[std::abs(j)] * overlap(i - j);
  return sum;
}

}  // namespace lightwell
