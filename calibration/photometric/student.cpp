// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/student.h"

#include <cmath>

namespace lightwell::calibration {

// With t = √ν tan φ the density becomes cos^(ν−1) φ, smooth on a bounded interval, which Simpson's rule integrates.
double student_cdf(double t, double degrees) {
  constexpr int kSteps = 2000;  // the error is below (π/2/2000)⁴ ν² / 180: 1e-13 at ν = 10
  const double end = std::atan(std::abs(t) / std::sqrt(degrees));
  const double h = end / kSteps;
  double sum = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double weight = i == 0 || i == kSteps ? 1 : i % 2 != 0 ? 4 : 2;
    sum += weight * std::pow(std::cos(h * i), degrees - 1);
  }
  const double norm =
      std::exp(std::lgamma((degrees + 1) / 2) - std::lgamma(degrees / 2)) / std::sqrt(std::acos(-1.0));
  const double half = sum * h / 3 * norm;
  return t < 0 ? 0.5 - half : 0.5 + half;
}

double student_two_sided(double probability, double degrees) {
  double low = 0, high = 1;
  while (2 * student_cdf(high, degrees) - 1 < probability && high < 1e12) high *= 2;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (2 * student_cdf(middle, degrees) - 1 < probability ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace lightwell::calibration
