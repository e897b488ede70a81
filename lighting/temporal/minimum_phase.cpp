// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/temporal/minimum_phase.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <string>

#include "lighting/vector.h"

namespace lightwell {
namespace {

using Complex = std::complex<double>;

// Zeros of Σ taps[n] z^(N−n), first tap not 0: eigenvalues of the companion matrix, then Newton's steps.
std::vector<Complex> zeros_of(std::span<const double> taps) {
  const auto degree = static_cast<Eigen::Index>(taps.size()) - 1;
  if (degree < 1) return {};
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(degree, degree);
  for (Eigen::Index i = 0; i < degree; ++i)
    companion(0, i) = -taps[static_cast<std::size_t>(i + 1)] / taps[0];
  for (Eigen::Index i = 1; i < degree; ++i) companion(i, i - 1) = 1;
  const Eigen::VectorXcd eigenvalues = Eigen::EigenSolver<Eigen::MatrixXd>(companion, false).eigenvalues();
  std::vector<Complex> zeros(eigenvalues.begin(), eigenvalues.end());
  for (Complex& zero : zeros)
    for (int step = 0; step < 3; ++step) {
      Complex value = 0;
      Complex slope = 0;
      for (const double tap : taps) {
        slope = slope * zero + value;
        value = value * zero + tap;
      }
      const Complex move = value / slope;
      if (!(std::abs(move) < 1e-3)) break;  // a double zero, or none near: the eigenvalue is better
      zero -= move;
    }
  return zeros;
}

double gain_at(std::span<const double> taps, double radians_per_frame) {
  Complex sum = 0;
  for (std::size_t n = 0; n < taps.size(); ++n)
    sum += taps[n] * std::polar(1.0, -radians_per_frame * static_cast<double>(n));
  return std::abs(sum);
}

// Taps from zeros through the response on the unit circle: multiplied out, coefficients of many zeros lose all
// digits; factor by factor on the circle, none.
std::vector<double> taps_of(const std::vector<Complex>& zeros) {
  const std::size_t count = zeros.size() + 1;
  std::vector<Complex> response(count, 1.0);
  for (std::size_t k = 0; k < count; ++k) {
    const Complex delay = std::polar(1.0, -2 * kPi * static_cast<double>(k) / static_cast<double>(count));
    for (const Complex& zero : zeros) response[k] *= 1.0 - zero * delay;
  }
  std::vector<double> taps(count, 0);
  for (std::size_t n = 0; n < count; ++n)
    for (std::size_t k = 0; k < count; ++k)
      taps[n] += (response[k] *
                  std::polar(1.0, 2 * kPi * static_cast<double>(k * n % count) / static_cast<double>(count)))
                     .real() /
                 static_cast<double>(count);
  return taps;
}

}  // namespace

Result<std::vector<double>> minimum_phase(std::span<const double> taps) {
  // Taps of 0 at either end are delay or length, no zeros: taken off, and put back behind.
  std::size_t first = 0;
  std::size_t last = taps.size();
  while (first < last && taps[first] == 0) ++first;
  while (last > first && taps[last - 1] == 0) --last;
  verify_bug(first < last, "a filter needs a tap that is not 0");
  const std::span<const double> inner = taps.subspan(first, last - first);
  std::vector<Complex> zeros = zeros_of(inner);
  for (Complex& zero : zeros)
    if (std::abs(zero) > 1) zero = 1.0 / std::conj(zero);
  std::vector<double> found = taps_of(zeros);

  constexpr int kPoints = 1024;
  double largest = 0;
  double largest_found = 0;
  for (int i = 0; i <= kPoints; ++i) {
    largest = std::max(largest, gain_at(inner, kPi * i / kPoints));
    largest_found = std::max(largest_found, gain_at(found, kPi * i / kPoints));
  }
  double sum = 0;
  for (const double tap : inner) sum += tap;
  double sum_found = 0;
  for (const double tap : found) sum_found += tap;
  const double scale = std::copysign(largest / largest_found, sum * sum_found);
  for (double& tap : found) tap *= scale;
  double deviation = 0;
  for (int i = 0; i <= kPoints; ++i)
    deviation =
        std::max(deviation, std::abs(gain_at(inner, kPi * i / kPoints) - gain_at(found, kPi * i / kPoints)));
  if (!(deviation <= 1e-6 * largest))
    return Error{ErrorKind::failed, "no minimum-phase filter of order " + std::to_string(taps.size() - 1) +
                                        " found: its zeros lie too close; lower the order"};
  found.resize(taps.size(), 0);
  return found;
}

double delay_of_slow_changes(std::span<const double> taps) {
  double sum = 0;
  double moment = 0;
  for (std::size_t n = 0; n < taps.size(); ++n) {
    sum += taps[n];
    moment += static_cast<double>(n) * taps[n];
  }
  return moment / sum;
}

}  // namespace lightwell
