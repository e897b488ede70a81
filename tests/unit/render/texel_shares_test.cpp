// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/texel_shares.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace lightwell::render {
namespace {

double blur(const std::vector<double>& powers, const std::vector<int>& sides) {
  double sum = 0;
  for (std::size_t i = 0; i < powers.size(); ++i) sum += powers[i] / sides[i];
  return sum;
}

double texels(const std::vector<int>& sides) {
  double sum = 0;
  for (const int side : sides) sum += 1.0 * side * side;
  return sum;
}

TEST(TexelShares, EqualLightsHaveEqualMapsOfTheWholeBudget) {
  for (const int side : share_texels(std::vector<double>(72, 0.3), 64, 1024, 72.0 * 256 * 256))
    EXPECT_EQ(side, 256);
}

TEST(TexelShares, ASunHasTheLargestMapAndAllStayWithinTheBudget) {
  std::vector<double> powers(72, 1);
  powers[5] = 400;
  const auto sides = share_texels(powers, 64, 1024, 72.0 * 256 * 256);
  EXPECT_EQ(sides[5], 1024);
  EXPECT_LE(texels(sides), 72.0 * 256 * 256);
  for (const int side : sides) EXPECT_GE(side, 128);
}

// Every choice of powers of two, tried.
TEST(TexelShares, BlurIsWithinAThirdOfTheLeastThatTheBudgetAllows) {
  std::mt19937 random(5);
  std::lognormal_distribution<double> power(0, 2);
  for (int round = 0; round < 20; ++round) {
    std::vector<double> powers;
    for (int i = 0; i < 5; ++i) powers.push_back(power(random));
    const double budget = 5 * 16;
    double least = std::numeric_limits<double>::infinity();
    for (int choice = 0; choice < 1024; ++choice) {
      std::vector<int> sides;
      for (int i = 0; i < 5; ++i) sides.push_back(1 << (choice >> (2 * i) & 3));
      if (texels(sides) <= budget) least = std::min(least, blur(powers, sides));
    }
    const auto sides = share_texels(powers, 1, 8, budget);
    EXPECT_LE(texels(sides), budget);
    EXPECT_LE(blur(powers, sides), 1.3 * least);  // of five maps the last doubling that does not fit is much
  }
}

TEST(TexelShares, LightsWithoutPowerAndNoLightsAreFine) {
  EXPECT_TRUE(share_texels({}, 64, 1024, 0).empty());
  EXPECT_EQ(share_texels(std::vector<double>{0, 0}, 64, 64, 1).size(), 2u);
  EXPECT_EQ(share_texels(std::vector<double>{0, 0}, 64, 1024, 1)[1], 64);
}

}  // namespace
}  // namespace lightwell::render
