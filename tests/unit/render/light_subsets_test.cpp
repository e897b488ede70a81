// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/light_subsets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "lighting/vector.h"

namespace lightwell::render {
namespace {

LightRow row_of(const Vec3f& direction, float power) {
  LightRow row{};
  const Vec3f d = direction.normalized();
  std::copy_n(d.data(), 3, row.to_light);
  std::fill_n(row.illuminance, 3, power);
  return row;
}

// Evenly over the upper hemisphere (Fibonacci's spiral), in random order.
std::vector<LightRow> sky(std::size_t count) {
  std::vector<LightRow> rows;
  for (std::size_t i = 0; i < count; ++i) {
    const double y = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double turn = kPi * (3 - std::sqrt(5.0)) * static_cast<double>(i);
    const double r = std::sqrt(1 - y * y);
    rows.push_back(row_of(Vec3d(r * std::cos(turn), y, r * std::sin(turn)).cast<float>(), 1));
  }
  std::shuffle(rows.begin(), rows.end(), std::mt19937(3));
  return rows;
}

// With one that makes all of these weak, from below.
std::vector<LightRow> beside_a_sun(std::vector<LightRow> rows) {
  rows.push_back(row_of({0, -1, 0}, 1e6f));
  return rows;
}

bool same(const LightRow& a, const LightRow& b) {
  return std::equal(a.to_light, a.to_light + 3, b.to_light) && a.illuminance[0] == b.illuminance[0];
}

TEST(LightSubsets, HoldEveryLightOnceAndStrongOnesFirst) {
  const std::vector<LightRow> before = [] {
    std::vector<LightRow> rows = sky(100);
    rows.insert(rows.begin() + 40, row_of({1, 2, 3}, 50));
    rows.insert(rows.begin() + 70, row_of({3, 1, -3}, 30));
    return rows;
  }();
  for (const int side : {1, 2, 4}) {
    std::vector<LightRow> rows = before;
    const std::size_t strong = arrange_subsets(rows, rows, side);
    ASSERT_EQ(rows.size(), before.size());
    for (const LightRow& row : before)
      EXPECT_EQ(std::count_if(rows.begin(), rows.end(), [&](const auto& r) { return same(r, row); }), 1);
    if (side == 1) {
      EXPECT_EQ(strong, before.size());
      EXPECT_TRUE(std::equal(rows.begin(), rows.end(), before.begin(), same));
    } else {
      // And those beside the two lamps, within 8°: 100 · 2π(1 − cos 8°) / 2π is one each, two by chance.
      EXPECT_GE(strong, 2u);
      EXPECT_LE(strong, 8u);
      EXPECT_TRUE(std::any_of(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(strong),
                              [](const LightRow& r) { return r.illuminance[0] == 50; }));
    }
  }
}

TEST(LightSubsets, LightsThatAreWeakAloneAreStrongTogetherWhereTheyStandTogether) {
  std::vector<LightRow> rows = sky(100);
  // Ten of a hundred and ten in one place: a lamp that many lights stand for.
  for (int i = 0; i < 10; ++i) rows.push_back(row_of({1, 1, 0.01f * static_cast<float>(i)}, 1));
  const std::size_t strong = arrange_subsets(rows, rows, 4);
  for (int i = 0; i < 10; ++i) {
    const LightRow lamp = row_of({1, 1, 0.01f * static_cast<float>(i)}, 1);
    EXPECT_TRUE(std::any_of(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(strong),
                            [&](const LightRow& r) { return same(r, lamp); }));
  }
  EXPECT_LE(strong, 20u);
}

TEST(LightSubsets, ALampIsStrongWhereItsLightsAreDrawnInSeveralBlocks) {
  std::vector<LightRow> all = sky(100);
  for (int i = 0; i < 10; ++i) all.push_back(row_of({1, 1, 0.01f * static_cast<float>(i)}, 1));
  // The last two of the lamp's ten stand in the second block.
  std::vector<LightRow> block(all.begin(), all.begin() + 50);
  block.insert(block.end(), all.end() - 2, all.end());
  const std::size_t strong = arrange_subsets(block, all, 4);
  for (const LightRow& lamp : {all[108], all[109]})
    EXPECT_TRUE(std::any_of(block.begin(), block.begin() + static_cast<std::ptrdiff_t>(strong),
                            [&](const LightRow& r) { return same(r, lamp); }));
}

TEST(LightSubsets, FewWeakLightsAreDrawnAsStrongOnes) {
  for (const std::size_t count : {0, 1, 3, 31}) {
    std::vector<LightRow> rows = sky(count);
    EXPECT_EQ(arrange_subsets(rows, beside_a_sun(rows), 4), count);
  }
  std::vector<LightRow> rows = sky(32);
  EXPECT_EQ(arrange_subsets(rows, beside_a_sun(rows), 4), 0u);
}

// The irradiance that each subset, times their number, gives a level surface is near that of all: for 256 lights of a sky,
// 16 of them in a subset err by less than half of what a random 16 would: 1/√12 / ½ / √16 = 14 %.
TEST(LightSubsets, EachSubsetLightsALevelSurfaceAsAllDo) {
  std::vector<LightRow> rows = sky(256);
  ASSERT_EQ(arrange_subsets(rows, beside_a_sun(rows), 4), 0u);
  const auto irradiance = [&](std::size_t first, std::size_t step) {
    double sum = 0;
    for (std::size_t i = first; i < rows.size(); i += step) sum += static_cast<double>(rows[i].to_light[1]);
    return sum;
  };
  double squares = 0;
  for (std::size_t k = 0; k < 16; ++k)
    squares += std::pow(16 * irradiance(k, 16) / irradiance(0, 1) - 1, 2) / 16;
  EXPECT_LE(std::sqrt(squares), 0.07);
}

}  // namespace
}  // namespace lightwell::render
