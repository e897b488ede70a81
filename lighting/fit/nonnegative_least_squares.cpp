// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/fit/nonnegative_least_squares.h"

#include <array>
#include <cmath>

#include "lighting/result.h"

namespace lightwell {
namespace {

// Below this part of its own square a column is taken for a sum of the others: a hundred roundings.
constexpr double kDependent = 1e-13;

// The free unknowns' least squares by a Cholesky factor of their rows and columns; false where they depend on each other.
bool solve_free(const SmallMatrix& gram, const SmallVector& right, unsigned free, SmallVector& x) {
  std::array<Eigen::Index, kMostUnknowns> index{};
  Eigen::Index n = 0;
  for (Eigen::Index j = 0; j < gram.rows(); ++j)
    if ((free >> j & 1u) != 0) index[static_cast<std::size_t>(n++)] = j;
  SmallMatrix factor(n, n);
  SmallVector y(n);
  for (Eigen::Index r = 0; r < n; ++r) {
    const auto row = index[static_cast<std::size_t>(r)];
    double value = right[row];
    double diagonal = gram(row, row);
    for (Eigen::Index c = 0; c < r; ++c) {
      double sum = gram(row, index[static_cast<std::size_t>(c)]);
      for (Eigen::Index k = 0; k < c; ++k) sum -= factor(r, k) * factor(c, k);
      factor(r, c) = sum / factor(c, c);
      diagonal -= factor(r, c) * factor(r, c);
      value -= factor(r, c) * y[c];
    }
    if (!(diagonal > kDependent * gram(row, row))) return false;
    factor(r, r) = std::sqrt(diagonal);
    y[r] = value / factor(r, r);
  }
  x.setZero();
  for (Eigen::Index r = n; r-- > 0;) {
    double value = y[r];
    for (Eigen::Index k = r + 1; k < n; ++k) value -= factor(k, r) * x[index[static_cast<std::size_t>(k)]];
    x[index[static_cast<std::size_t>(r)]] = value / factor(r, r);
  }
  return true;
}

bool all_positive(const SmallVector& x, unsigned free) {
  for (Eigen::Index j = 0; j < x.size(); ++j)
    if ((free >> j & 1u) != 0 && !(x[j] > 0)) return false;
  return true;
}

// From x, feasible, toward the free unknowns' optimum as far as all stay ≥ 0; what reaches 0 is no longer free.
void step_toward(const SmallVector& wanted, SmallVector& x, unsigned& free) {
  double step = 1;
  Eigen::Index first = -1;
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    if ((free >> j & 1u) == 0 || wanted[j] > 0) continue;
    const double reach = x[j] / (x[j] - wanted[j]);
    if (first < 0 || reach < step) {
      step = reach;
      first = j;
    }
  }
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    if ((free >> j & 1u) == 0) continue;
    x[j] += step * (wanted[j] - x[j]);
    if (j != first && x[j] > 0) continue;
    x[j] = 0;
    free &= ~(1u << j);
  }
}

}  // namespace

NonnegativeSolution solve_nonnegative(const SmallMatrix& gram, const SmallVector& right,
                                      unsigned first_guess) {
  const Eigen::Index n = gram.rows();
  NonnegativeSolution solution;
  solution.x = SmallVector::Zero(n);
  SmallVector wanted = SmallVector::Zero(n);
  // What was free before mostly is again.
  if (first_guess != 0 && solve_free(gram, right, first_guess, wanted) && all_positive(wanted, first_guess)) {
    solution.positive = first_guess;
    solution.x = wanted;
  }
  unsigned refused = 0;
  // Every round frees one unknown for good or refuses it: rounding alone could go round in circles.
  for (Eigen::Index round = 0; round < 4 * n; ++round) {
    Eigen::Index best = -1;
    double steepest = 0;
    for (Eigen::Index j = 0; j < n; ++j) {
      if (((solution.positive | refused) >> j & 1u) != 0) continue;
      const double slope = (right[j] - gram.row(j).dot(solution.x)) / std::sqrt(gram(j, j));
      // A slope that is rounding of what it is the difference of leads nowhere.
      if (slope > steepest && slope * std::sqrt(gram(j, j)) > 1e-14 * std::abs(right[j])) {
        steepest = slope;
        best = j;
      }
    }
    if (best < 0) break;
    const unsigned wider = solution.positive | 1u << best;
    if (!solve_free(gram, right, wider, wanted) || !(wanted[best] > 0)) {
      refused |= 1u << best;
      continue;
    }
    solution.positive = wider;
    while (!all_positive(wanted, solution.positive)) {
      step_toward(wanted, solution.x, solution.positive);
      verify_bug(solve_free(gram, right, solution.positive, wanted),
                 "fewer columns depend where more did not");
    }
    solution.x = wanted;
    refused = 0;
  }
  solution.decrease = 0.5 * right.dot(solution.x);
  return solution;
}

}  // namespace lightwell
