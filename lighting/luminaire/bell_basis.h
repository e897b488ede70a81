// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace lightwell {

// The basis of a lamp's sampling plane in one dimension, spacing 1: translates of a piecewise quadratic bell. They sum to
// 1 everywhere. In two dimensions: products.
// source: Granier et al. 2003, equation 6
double bell(double x) noexcept;  // 0 where |x| ≥ 1
inline constexpr double kBellReach = 1;

// Filters Φ' that take a function of the bells' span apart: ∫ Φ'(x) Φ(x − n) dx = δ_n0. A dual is not unique.
enum class BellDual {
  canonical,  // inside the span, the least noise: Σ c α^|k| Φ(x − k), α = −0.155871; falls without end
  finite,     // Σ c_k Φ(x − k / 2), |k| ≤ 2: ends at ±2, so that a slide can be made of it
};
double bell_dual(BellDual dual, double x) noexcept;
// Beyond it the dual is 0, or below 1e-15.
double bell_dual_reach(BellDual dual) noexcept;
// ∫ Φ'² dx: what white noise on the sampling plane is multiplied by.
double bell_dual_noise(BellDual dual) noexcept;

}  // namespace lightwell
