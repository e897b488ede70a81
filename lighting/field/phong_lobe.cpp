// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/phong_lobe.h"

#include <algorithm>
#include <cmath>

#include "lighting/result.h"

namespace lightwell {

void phong_moments(double exponent, int degree, double* moments) noexcept {
  verify_bug(exponent >= 0 && degree >= 0 && degree <= kMostDegree,
             "exponent or degree of a lobe out of range");
  moments[0] = 1 / (exponent + 1);
  if (degree > 0) moments[1] = 1 / (exponent + 2);
  for (int l = 2; l <= degree; ++l) moments[l] = moments[l - 2] * (exponent - l + 2) / (exponent + l + 1);
}

void phong_lobe(const Vec3d& axis, double exponent, int degree, double* coefficients) noexcept {
  std::array<double, kMostDegree + 1> moments;
  phong_moments(exponent, degree, moments.data());
  harmonics(axis, degree, coefficients);
  for (int l = 0; l <= degree; ++l)
    for (int m = -l; m <= l; ++m)
      coefficients[harmonic_index(l, m)] *= 2 * kPi * moments[static_cast<std::size_t>(l)];
}

// ‖lobe‖² = 2π / (2s + 1); a band keeps (2l + 1) / 4π · (2π I_l)² of it.
double phong_truncation(double exponent, int degree) noexcept {
  std::array<double, kMostDegree + 1> moments;
  phong_moments(exponent, degree, moments.data());
  double kept = 0;
  for (int l = 0; l <= degree; ++l) {
    const double moment = moments[static_cast<std::size_t>(l)];
    kept += (2 * l + 1) * kPi * moment * moment;
  }
  return std::sqrt(std::max(0.0, 1 - kept * (2 * exponent + 1) / (2 * kPi)));
}

}  // namespace lightwell
