// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/clustering.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace lightwell {
namespace {

LightArrays random_lights(std::size_t count, double theta_max, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  LightArrays lights(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double y = 1 - uniform(random) * (1 - std::cos(theta_max));
    const double lambda = 2 * kPi * uniform(random);
    const double h = std::sqrt(std::max(0.0, 1 - y * y));
    lights.x[i] = static_cast<float>(h * std::sin(lambda));
    lights.y[i] = static_cast<float>(y);
    lights.z[i] = static_cast<float>(h * std::cos(lambda));
    lights.r[i] = static_cast<float>(uniform(random));
    lights.g[i] = static_cast<float>(uniform(random));
    lights.b[i] = static_cast<float>(uniform(random));
  }
  return lights;
}

Rgbd total(const LightArrays& lights) {
  Rgbd sum = Rgbd::Zero();
  for (std::size_t i = 0; i < lights.size(); ++i)
    sum += Rgb(lights.r[i], lights.g[i], lights.b[i]).cast<double>();
  return sum;
}

Rgbd total(std::span<const DirectionalLight> lights) {
  Rgbd sum = Rgbd::Zero();
  for (const auto& light : lights) sum += light.illuminance.cast<double>();
  return sum;
}

TEST(Clustering, RadiusIsThePapersOnTheHemisphere) {
  EXPECT_NEAR(cluster_radius_rad(72, 2 * kPi, 1.85), 1.85 * std::asin(std::sqrt(2.0 / 72)), 1e-12);
  EXPECT_NEAR(cluster_radius_rad(2, 2 * kPi, 1.85) * 180 / kPi, 166.5, 1e-9);
  EXPECT_NEAR(cluster_radius_rad(1, 2 * kPi, 1.85), 1.85 * kPi / 2, 1e-12)
      << "outside of the domain: the root is held to 1";
}

TEST(Clustering, NeverMoreThanQAndTotalPowerIsKept) {
  for (const double theta_max : {kPi / 3, kPi / 2, 1.9, kPi})
    for (const int q : {1, 2, 3, 5, 16, 72, 300, 1000})
      for (const std::size_t n : {std::size_t{1}, std::size_t{2}, std::size_t{37}, std::size_t{300}}) {
        const LightArrays lights = random_lights(n, theta_max, static_cast<unsigned>(q) + 7);
        Clustering clustering(q, theta_max);
        const auto out = clustering.apply(lights);
        ASSERT_GE(out.size(), 1u);
        EXPECT_LE(out.size(), static_cast<std::size_t>(q));
        // Sums in double, each cluster rounded to float once.
        EXPECT_LT(((total(out) - total(lights)) / total(lights)).abs().maxCoeff(), 1e-7);
        for (const auto& light : out) {
          EXPECT_NEAR(light.direction.norm(), 1, 1e-6);
          EXPECT_GE(light.direction.y(), std::cos(theta_max) - 2e-6);
        }
      }
}

TEST(Clustering, SeedsStandInProgressiveOrder) {
  const LightArrays lights = random_lights(300, kPi / 2, 3);
  Clustering clustering(72, kPi / 2);
  const auto out = clustering.apply(lights);
  EXPECT_EQ(out[0].id, 0u);
  for (std::size_t i = 1; i < out.size(); ++i) EXPECT_LT(out[i - 1].id, out[i].id);
}

TEST(Clustering, AgreesWithThePapersGreedyPassWhereItStaysBelowQ) {
  // Independent and plain: the first free light takes every free light within the radius.
  const LightArrays lights = random_lights(300, kPi / 2, 4);
  const double cosine = std::cos(cluster_radius_rad(72, 2 * kPi));
  std::vector<bool> taken(300, false);
  std::vector<Rgbd> expected;
  for (std::size_t i = 0; i < 300; ++i) {
    if (taken[i]) continue;
    Rgbd sum = Rgbd::Zero();
    for (std::size_t j = i; j < 300; ++j) {
      const float dot = lights.x[i] * lights.x[j] + lights.y[i] * lights.y[j] + lights.z[i] * lights.z[j];
      if (taken[j] || static_cast<double>(dot) < cosine) continue;
      taken[j] = true;
      sum += Rgb(lights.r[j], lights.g[j], lights.b[j]).cast<double>();
    }
    expected.push_back(sum);
  }
  ASSERT_LT(expected.size(), 72u);
  Clustering clustering(72, kPi / 2);
  const auto out = clustering.apply(lights);
  ASSERT_EQ(out.size(), expected.size());
  for (std::size_t c = 0; c < out.size(); ++c)
    EXPECT_LT((out[c].illuminance.cast<double>() - expected[c]).abs().maxCoeff(), 1e-5);  // float rounding
}

TEST(Clustering, ManyLightsInOnePlaceBecomeOne) {
  LightArrays lights(100);
  for (std::size_t i = 0; i < 100; ++i) lights.r[i] = lights.g[i] = lights.b[i] = 1;
  Clustering clustering(72, kPi / 2);
  const auto out = clustering.apply(lights);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_NEAR(out[0].illuminance[0], 100, 1e-4);
  EXPECT_NEAR(out[0].direction.y(), 1, 1e-6);
}

TEST(Clustering, DirectionIsThePowerWeightedMean) {
  LightArrays lights(2);
  lights.x = {0.0f, 0.1f};
  lights.y = {1.0f, std::sqrt(0.99f)};
  lights.r = lights.g = lights.b = {1.0f, 3.0f};
  Clustering clustering(1, kPi / 2);
  const auto out = clustering.apply(lights);
  const Vec3f expected = (Vec3f(0, 1, 0) + 3 * Vec3f(0.1f, std::sqrt(0.99f), 0)).normalized();
  EXPECT_LT((out[0].direction - expected).norm(), 1e-6);  // float rounding
}

TEST(Clustering, OppositeMembersAndNoPowerFallBackToTheSeed) {
  LightArrays lights(2);
  lights.x = {1, -1};
  lights.y = {0, 0};
  lights.r = lights.g = lights.b = {1, 1};
  Clustering clustering(1, kPi);
  EXPECT_EQ(clustering.apply(lights)[0].direction, Vec3f(1, 0, 0));
  lights.r = lights.g = lights.b = {0, 0};
  lights.x = {0.6f, 0.6f};
  lights.y = {0.8f, 0.8f};
  EXPECT_EQ(clustering.apply(lights)[0].direction, Vec3f(0.6f, 0.8f, 0));
}

}  // namespace
}  // namespace lightwell
