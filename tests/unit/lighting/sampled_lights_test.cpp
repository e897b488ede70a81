// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/sampled_lights.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lighting/decomposition/decompose.h"
#include "lighting/light_pipeline.h"
#include "lighting/sampling/random_points.h"
#include "tests/support/decomposition_maps.h"

namespace lightwell {
namespace {

TEST(RandomPoints, FillTheSquareAsIndependentPointsDo) {
  constexpr std::size_t kCount = 64000;
  std::vector<int> cell(64, 0);
  double product = 0;
  Vec2d last(0.5, 0.5);
  for (const Vec2d& p : random_points(kCount, 11)) {
    ASSERT_TRUE((p.array() >= 0).all() && (p.array() < 1).all());
    ++cell[static_cast<std::size_t>(p.x() * 8) * 8 + static_cast<std::size_t>(p.y() * 8)];
    product += (p.x() - 0.5) * (last.y() - 0.5) / kCount;
    last = p;
  }
  // Chi squared of 64 cells of 1000: 63 ± 11; five standard deviations. Correlation: variance 1/144 over √64000.
  double chi2 = 0;
  for (const int n : cell) chi2 += (n - 1000.0) * (n - 1000.0) / 1000;
  EXPECT_LT(chi2, 63 + 5 * 11.3);
  EXPECT_GT(chi2, 63 - 5 * 11.3);
  EXPECT_LT(std::abs(product), 5.0 / 12 / std::sqrt(64000.0));
}

TEST(RandomPoints, SeedsDifferAndPrefixesDoNotDependOnCount) {
  const auto few = random_points(10, 1);
  const auto many = random_points(100, 1);
  for (std::size_t i = 0; i < few.size(); ++i) EXPECT_EQ(few[i], many[i]);
  const auto other = random_points(10, 2);
  for (std::size_t i = 0; i < few.size(); ++i)
    for (std::size_t j = 0; j < other.size(); ++j) EXPECT_NE(few[i], other[j]);
}

TEST(SampledLights, AreThePipelinesOfOneFrame) {
  const PolarMap map = test::outdoor({45, 180, kPi / 2});
  for (const auto sampler : {LightPipelineOptions::Sampler::standard, LightPipelineOptions::Sampler::havran})
    for (const std::uint32_t seed : {0u, 77u}) {
      LightPipelineOptions options;
      options.count = 50;
      options.sampler = sampler;
      options.seed = seed;
      options.relaxed = sampler == LightPipelineOptions::Sampler::havran;
      options.filter = TemporalFilter::none;
      options.clusters = 0;
      auto pipeline = LightPipeline::create(map.grid, map.channels, options).value();
      const auto expected = pipeline.process(map);
      const auto lights = sampler == LightPipelineOptions::Sampler::havran
                              ? havran_lights(map, 50, Points::relaxed, Interpolation::power, seed)
                              : standard_lights(map, 50, Points::halton, seed);
      ASSERT_EQ(lights.size(), expected.size());
      for (std::size_t i = 0; i < lights.size(); ++i) {
        EXPECT_EQ(lights[i].direction, expected[i].direction);
        EXPECT_TRUE((lights[i].illuminance == expected[i].illuminance).all());
        EXPECT_EQ(lights[i].id, expected[i].id);
      }
    }
}

TEST(SampledLights, RandomPointsConvergeAsTheRootOfTheirCountAndHaltonsFaster) {
  // The mean direction of the lights, of a sky: root mean square over seeds.
  const PolarMap map = test::sun_and_sky({45, 180, kPi / 2}, 50, 40, 0.3);
  const auto off = [&](Points points, int count) {
    Vec3d expected = Vec3d::Zero();
    for (int ring = 0; ring < 45; ++ring)
      for (int sector = 0; sector < 180; ++sector) {
        const auto bin = static_cast<std::size_t>(ring * 180 + sector);
        expected += luminance(map.rgb(bin).cast<double>().eval()) * map.grid.bin_solid_angle_sr(ring) *
                    map.grid.bin_direction(ring, sector);
      }
    expected /= luminance(total_illuminance(map));
    double square = 0;
    for (std::uint32_t seed = 1; seed <= 30; ++seed) {
      Vec3d mean = Vec3d::Zero();
      for (const auto& light : standard_lights(map, count, points, seed))
        mean += light.direction.cast<double>() / count;
      square += (mean - expected).squaredNorm() / 30;
    }
    return std::sqrt(square);
  };
  // 16 times the lights: a quarter of the error; 30 seeds know it to an eighth.
  EXPECT_NEAR(off(Points::random, 64) / off(Points::random, 1024), 4, 1.5);
  EXPECT_LT(off(Points::halton, 1024), 0.3 * off(Points::random, 1024));
}

TEST(DecomposeOptions, DefaultsAreTheMethodsOwn) {
  const auto options = [](Method method) { return resolved(method, {}).value(); };
  EXPECT_EQ(options(Method::standard).points, Points::halton);
  EXPECT_FALSE(options(Method::standard).interpolation);
  EXPECT_EQ(options(Method::havran).points, Points::relaxed);
  EXPECT_EQ(options(Method::havran).interpolation, Interpolation::power);
  EXPECT_FALSE(options(Method::best).points);
}

TEST(DecomposeOptions, WhatDoesNotApplyIsWrongUsage) {
  const PolarMap map = test::outdoor({4, 8, kPi});
  for (const Method method : kMethods) {
    for (const Points points : {Points::random, Points::halton, Points::relaxed}) {
      DecomposeOptions options;
      options.points = points;
      const bool applies = (method == Method::standard && points != Points::relaxed) ||
                           (method == Method::havran && points != Points::random);
      const auto set = decompose(map, method, 4, options);
      EXPECT_EQ(set.ok(), applies) << name(method) << " " << name(points);
      if (!set) {
        EXPECT_EQ(set.error().kind, ErrorKind::usage);
      }
    }
    DecomposeOptions options;
    options.interpolation = Interpolation::printed;
    EXPECT_EQ(decompose(map, method, 4, options).ok(), method == Method::havran) << name(method);
  }
}

TEST(DecomposeOptions, NamesGoThereAndBack) {
  for (const Powers p : {Powers::own, Powers::cells, Powers::means, Powers::equal})
    EXPECT_EQ(powers_from_name(name(p)), p);
  for (const Points p : {Points::random, Points::halton, Points::relaxed})
    EXPECT_EQ(points_from_name(name(p)), p);
  for (const Interpolation i : {Interpolation::power, Interpolation::printed})
    EXPECT_EQ(interpolation_from_name(name(i)), i);
  EXPECT_FALSE(powers_from_name(""));
}

}  // namespace
}  // namespace lightwell
