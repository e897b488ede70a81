// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/luminaire/bell_basis.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace lightwell {
namespace {

// Both bells and duals are quadratic between half steps: Gauss–Legendre of three points is exact for their products.
double integral(double from, double to, const std::function<double(double)>& f) {
  double sum = 0;
  const double x = std::sqrt(0.6) / 4;
  for (double a = from; a < to - 1e-9; a += 0.5)
    sum += 0.5 * (5 * f(a + 0.25 - x) + 8 * f(a + 0.25) + 5 * f(a + 0.25 + x)) / 18;
  return sum;
}

TEST(Bell, IsThePapersAndSumsToOne) {
  EXPECT_EQ(bell(0), 1);
  EXPECT_EQ(bell(0.5), 0.5);
  EXPECT_EQ(bell(-1), 0);
  EXPECT_DOUBLE_EQ(bell(0.75), 0.125);
  for (double x = -0.5; x <= 0.5; x += 0.01) EXPECT_NEAR(bell(x - 1) + bell(x) + bell(x + 1), 1, 1e-15);
}

TEST(Bell, DualsTakeTheBellsApart) {
  for (const BellDual dual : {BellDual::canonical, BellDual::finite}) {
    const double reach = bell_dual_reach(dual);
    for (int n = -6; n <= 6; ++n)
      EXPECT_NEAR(integral(-reach - 8, reach + 8, [&](double x) { return bell_dual(dual, x) * bell(x - n); }),
                  n == 0 ? 1 : 0, 1e-14)
          << n;
    EXPECT_NEAR(integral(-reach, reach, [&](double x) { return bell_dual(dual, x); }), 1, 1e-14);
    EXPECT_NEAR(integral(-reach, reach, [&](double x) { return std::pow(bell_dual(dual, x), 2); }),
                bell_dual_noise(dual), 1e-13);
    EXPECT_LT(std::abs(bell_dual(dual, reach)), 1e-15);
  }
  EXPECT_LT(bell_dual_noise(BellDual::canonical), bell_dual_noise(BellDual::finite)) << "no dual is quieter";
}

// α as the Gram matrix has it (23/30 and 7/60).
TEST(Bell, TheCanonicalDualFallsByAlphaAStep) {
  EXPECT_NEAR(bell_dual(BellDual::canonical, 3) / bell_dual(BellDual::canonical, 2), -0.155871, 1e-6);
}

}  // namespace
}  // namespace lightwell
