// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/student.h"

#include <cmath>

namespace lightwell::calibration {
namespace {

// Γ((ν + 1)/2) / (Γ(ν/2) √π)
double normalisation(double degrees) {
  return std::exp(std::lgamma((degrees + 1) / 2) - std::lgamma(degrees / 2)) / std::sqrt(std::acos(-1.0));
}

}  // namespace

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
  const double half = sum * h / 3 * normalisation(degrees);
  return t < 0 ? 0.5 - half : 0.5 + half;
}

// Newton: the distribution is concave above 0, so that steps from 0 never pass the root.
double student_two_sided(double probability, double degrees) {
  const double peak = normalisation(degrees) / std::sqrt(degrees);
  double t = 0;
  for (int i = 0; i < 200; ++i) {
    const double density = peak * std::pow(1 + t * t / degrees, -(degrees + 1) / 2);
    const double step = ((1 + probability) / 2 - student_cdf(t, degrees)) / density;
    t += step;
    if (!(step > 1e-11 * t)) break;
  }
  return t;
}

}  // namespace lightwell::calibration
