// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

namespace lightwell {

// c[0] + c[1] x + c[2] x² + …
double polynomial_value(const std::vector<double>& c, double x);

// Real roots inside (lo, hi) where the polynomial changes sign, in order. Between neighbouring roots of its
// derivative a polynomial is monotone, so each such interval holds at most one root and bisection cannot miss
// it.
std::vector<double> polynomial_roots(const std::vector<double>& c, double lo, double hi);

// Smallest value on [lo, hi] and where it is: (x, value).
std::pair<double, double> polynomial_minimum(const std::vector<double>& c, double lo, double hi);

}  // namespace lightwell
