// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/polynomial.h"

#include <cstddef>

namespace lightwell {
namespace {

std::vector<double> derivative(const std::vector<double>& c) {
  std::vector<double> d;
  for (std::size_t i = 1; i < c.size(); ++i) d.push_back(static_cast<double>(i) * c[i]);
  return d;
}

// A sign change lies between lo and hi; 200 halvings exhaust a double.
double bisect(const std::vector<double>& c, double lo, double hi) {
  const bool rising = polynomial_value(c, lo) < 0;
  for (int i = 0; i < 200; ++i) {
    const double mid = lo + (hi - lo) / 2;
    if (mid <= lo || mid >= hi) break;
    ((polynomial_value(c, mid) < 0) == rising ? lo : hi) = mid;
  }
  return lo + (hi - lo) / 2;
}

}  // namespace

double polynomial_value(const std::vector<double>& c, double x) {
  double value = 0;
  for (std::size_t i = c.size(); i-- > 0;) value = value * x + c[i];
  return value;
}

std::vector<double> polynomial_roots(const std::vector<double>& c, double lo, double hi) {
  std::vector<double> roots;
  if (c.size() < 2) return roots;
  std::vector<double> ends = polynomial_roots(derivative(c), lo, hi);
  ends.push_back(hi);
  double from = lo;
  for (const double to : ends) {
    if ((polynomial_value(c, from) < 0) != (polynomial_value(c, to) < 0))
      roots.push_back(bisect(c, from, to));
    from = to;
  }
  return roots;
}

std::pair<double, double> polynomial_minimum(const std::vector<double>& c, double lo, double hi) {
  std::vector<double> candidates = polynomial_roots(derivative(c), lo, hi);
  candidates.push_back(hi);
  std::pair<double, double> best = {lo, polynomial_value(c, lo)};
  for (const double x : candidates) {
    const double value = polynomial_value(c, x);
    if (value < best.second) best = {x, value};
  }
  return best;
}

}  // namespace lightwell
