// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/light_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "lighting/light_set.h"

namespace lightwell {
namespace {

std::vector<DirectionalLight> random_lights(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> exponent(-3, 3);
  std::vector<DirectionalLight> lights(count);
  for (std::size_t i = 0; i < count; ++i) {
    lights[i].direction = Vec3f(normal(random), normal(random), normal(random)).normalized();
    lights[i].illuminance = Rgb(1, 2, 3) * std::pow(10.0f, exponent(random));
    lights[i].id = static_cast<std::uint32_t>(i);
  }
  return lights;
}

void expect_tree_of(const std::vector<DirectionalLight>& lights, const std::vector<DirectionalLight>& tree) {
  ASSERT_EQ(tree.size(), lights.size());
  std::vector<bool> seen(lights.size(), false);
  for (std::size_t i = 0; i < tree.size(); ++i) {
    if (i == 0)
      EXPECT_EQ(tree[i].parent, -1);
    else
      EXPECT_TRUE(tree[i].parent >= 0 && tree[i].parent < static_cast<int>(i)) << i;
    const DirectionalLight& light = lights[tree[i].id];
    EXPECT_EQ(light.direction, tree[i].direction);
    EXPECT_TRUE((light.illuminance == tree[i].illuminance).all());
    EXPECT_FALSE(seen[tree[i].id]);
    seen[tree[i].id] = true;
  }
}

// Σ luminance · squared distance of all lights from the mean of the group that each is folded into.
double spread_of_cut(const std::vector<DirectionalLight>& tree, std::size_t count) {
  std::vector<std::size_t> group(tree.size());
  std::vector<Vec3d> moment(count, Vec3d::Zero());
  std::vector<double> weight(count, 0);
  const auto w = [&](std::size_t i) { return luminance(tree[i].illuminance.cast<double>().eval()); };
  for (std::size_t i = 0; i < tree.size(); ++i) {
    group[i] = i < count ? i : group[static_cast<std::size_t>(tree[i].parent)];
    moment[group[i]] += w(i) * tree[i].direction.cast<double>();
    weight[group[i]] += w(i);
  }
  double spread = 0;
  for (std::size_t i = 0; i < tree.size(); ++i)
    spread += w(i) * (tree[i].direction.cast<double>() - moment[group[i]] / weight[group[i]]).squaredNorm();
  return spread;
}

TEST(LightTree, IsATreeOfTheSameLights) {
  for (const std::size_t count : {1u, 2u, 3u, 17u, 500u}) {
    const auto lights = random_lights(count, 3);
    expect_tree_of(lights, as_tree(lights));
  }
  EXPECT_TRUE(as_tree({}).empty());
}

TEST(LightTree, TheFirstLightIsTheStrongest) {
  const auto lights = random_lights(50, 8);
  const auto tree = as_tree(lights);
  for (const auto& light : lights) EXPECT_GE(tree[0].illuminance[0], light.illuminance[0]);
}

TEST(LightTree, EveryLightMoreLessensTheSpread) {
  const auto tree = as_tree(random_lights(60, 4));
  double last = std::numeric_limits<double>::infinity();
  for (std::size_t n = 1; n <= tree.size(); ++n) {
    const double spread = spread_of_cut(tree, n);
    EXPECT_LT(spread, last) << n;
    last = spread;
  }
  EXPECT_NEAR(last, 0, 1e-12 * spread_of_cut(tree, 1));
}

TEST(LightTree, FirstDivisionIsNearlyTheBestOfAllPairsOfGroups) {
  // Independent: of 12 lights every one of the 2047 ways to divide them in two.
  double ratio = 0;
  constexpr int kSets = 20;
  for (unsigned set = 0; set < kSets; ++set) {
    auto lights = random_lights(12, set);
    for (auto& light : lights) light.illuminance = Rgb::Constant(std::sqrt(light.illuminance[0]));
    const auto spread = [&](unsigned members) {
      Vec3d moment = Vec3d::Zero();
      double weight = 0;
      double square = 0;
      for (unsigned i = 0; i < 12; ++i) {
        if ((members >> i & 1u) == 0) continue;
        const auto w = static_cast<double>(lights[i].illuminance[0]);
        weight += w;
        moment += w * lights[i].direction.cast<double>();
        square += w * lights[i].direction.cast<double>().squaredNorm();
      }
      return weight > 0 ? square - moment.squaredNorm() / weight : 0;
    };
    double least = std::numeric_limits<double>::infinity();
    for (unsigned members = 1; members < 2048; ++members)
      least = std::min(least, spread(members) + spread(4095 - members));
    ratio += spread_of_cut(as_tree(lights), 2) / least / kSets;
  }
  // Across the longest axis only: a tenth worse than the best plane on average.
  EXPECT_LT(ratio, 1.15);
  EXPECT_GE(ratio, 1 - 1e-6);
}

TEST(LightTree, LightsInOnePlaceAndWithoutPowerComeLast) {
  auto lights = random_lights(10, 5);
  for (int k = 0; k < 20; ++k) {
    lights.push_back(lights[static_cast<std::size_t>(k % 2)]);
    lights.back().id = static_cast<std::uint32_t>(lights.size() - 1);
    if (k % 3 == 0) lights.back().illuminance = Rgb::Zero();
  }
  const auto tree = as_tree(lights);
  expect_tree_of(lights, tree);
  for (std::size_t i = 0; i < 10; ++i)
    for (std::size_t j = 0; j < i; ++j) EXPECT_GT((tree[i].direction - tree[j].direction).norm(), 1e-3f);
}

TEST(LightTree, OfNoPowerIsATree) {
  auto lights = random_lights(40, 5);
  for (auto& light : lights) light.illuminance = Rgb::Zero();
  expect_tree_of(lights, as_tree(lights));
}

TEST(LightTree, PowersFrom1eMinus30To1e25AreDividedAlike) {
  const auto lights = random_lights(30, 6);
  const auto tree = as_tree(lights);
  for (const float factor : {0x1p-100f, 0x1p80f}) {
    auto scaled = lights;
    for (auto& light : scaled) light.illuminance *= factor;
    const auto other = as_tree(scaled);
    for (std::size_t i = 0; i < tree.size(); ++i) {
      EXPECT_EQ(tree[i].id, other[i].id);
      EXPECT_EQ(tree[i].parent, other[i].parent);
    }
  }
}

TEST(LightTree, TakesAHundredThousandLights) {
  const auto lights = random_lights(100000, 7);
  expect_tree_of(lights, as_tree(lights));
}

}  // namespace
}  // namespace lightwell
