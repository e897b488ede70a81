// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>
#include <string>
#include <utility>

#include "lighting/decomposition/decompose.h"
#include "lighting/evaluation/evaluate.h"
#include "tests/support/decomposition_maps.h"
#include "tests/support/sampling_maps.h"

// What every decomposition promises for every map. A method joins by one row of claims in
// tests/unit/lighting/decomposition_invariants_test.cpp: what it promises beyond that, each measured when written.
namespace lightwell::test {

struct MethodClaims {
  Method method;
  // Of a map with one lit bin of 2° by 2°: how far a light may lie from the bin's centre, degrees.
  double place_deg;
  // A map turned about the zenith by whole sectors: the factor by which both errors may grow or shrink.
  double rotation;
  // The map at half the resolution: the factor by which both errors may grow or shrink.
  double resolution;
  // The first 16 of 64 lights: their shadow error over that of 16 lights.
  double prefix;
};

// What every method promises for every map, with any of its options.
inline void expect_sound(const PolarMap& map, Method method, int count,
                         const DecomposeOptions& options = {}) {
  const auto result = decompose(map, method, count, options);
  ASSERT_TRUE(result) << result.error().message;
  const LightSet& set = *result;
  const std::string what = std::string(name(method)) + " " + std::to_string(count) + " powers " +
                           std::string(name(options.powers));
  ASSERT_EQ(set.lights.size(), static_cast<std::size_t>(count)) << what;
  for (std::size_t i = 0; i < set.lights.size(); ++i) {
    const DirectionalLight& light = set.lights[i];
    EXPECT_NEAR(light.direction.cast<double>().norm(), 1, 1e-6) << what;  // float rounding
    EXPECT_TRUE(light.illuminance.isFinite().all() && (light.illuminance >= 0).all()) << what;
    EXPECT_GE(light.direction.cast<double>().y(), std::cos(map.grid.theta_max_rad) - 1e-6) << what;
    if (!set.has_parents) continue;
    const bool earlier = light.parent >= 0 && light.parent < static_cast<int>(i);
    EXPECT_TRUE(i == 0 ? light.parent == -1 : earlier) << what;
  }
  const Rgbd total = total_illuminance(map);
  const double largest = std::max(total.maxCoeff(), 1e-300);
  // Float rounding of `count` lights; the samplers scale in float: a few parts in 10⁷ more.
  EXPECT_LT((sum(set) - total).abs().maxCoeff() / largest, 2e-6) << what;
  EXPECT_TRUE(((set.total_illuminance.cast<double>() - total).abs() <= 1e-7 * largest).all()) << what;
}

// 1 where they are equal, else how many times the larger is the smaller.
inline double apart(double a, double b) {
  return std::max(a, b) / std::min(a, b);
}

inline double apart(const LightError& a, const LightError& b) {
  return std::max(apart(a.irradiance_rel_rmse, b.irradiance_rel_rmse),
                  apart(a.shadow_rel_rmse, b.shadow_rel_rmse));
}

inline void PrintTo(const MethodClaims& claims, std::ostream* out) {
  *out << name(claims.method);
}

class DecompositionInvariants : public testing::TestWithParam<MethodClaims> {
 protected:
  [[nodiscard]] static Method method() { return GetParam().method; }
  [[nodiscard]] static LightSet lights(const PolarMap& map, int count) {
    return decompose(map, method(), count).value();
  }
};

TEST_P(DecompositionInvariants, SoundForAnyCountGridAndCoverage) {
  for (const PolarGrid& grid : {PolarGrid{45, 180, kPi / 2}, PolarGrid{37, 61, kPi}, PolarGrid{1, 1, kPi / 2},
                                PolarGrid{1, 2, kPi}, PolarGrid{20, 64, 93 * kDegree}})
    for (const int count : {1, 2, 3, 16, 65}) expect_sound(outdoor(grid), method(), count);
  expect_sound(outdoor({45, 180, kPi / 2}), method(), 1024);
}

TEST_P(DecompositionInvariants, SoundForManyLights) {
  expect_sound(outdoor({45, 180, kPi / 2}), method(), 3000);
  expect_sound(outdoor({1, 1, kPi / 2}), method(), 100000);
}

TEST_P(DecompositionInvariants, SoundWithAnyPowers) {
  const PolarMap map = outdoor({30, 90, kPi / 2});
  for (const Powers powers : {Powers::cells, Powers::means, Powers::equal}) {
    DecomposeOptions options;
    options.powers = powers;
    for (const int count : {1, 7, 64}) expect_sound(map, method(), count, options);
    expect_sound(PolarMap::make({9, 9, kPi}, 3), method(), 10, options);
    expect_sound(one_bin({9, 9, kPi}, 3, 3, 1), method(), 10, options);
  }
}

TEST_P(DecompositionInvariants, SoundOnHardMaps) {
  for (const auto& [name, map] : hard_maps()) {
    SCOPED_TRACE(name);
    for (const int count : {1, 5, 64}) expect_sound(map, method(), count);
  }
}

TEST_P(DecompositionInvariants, LightFromBeyondTheHorizonAloneStaysInTheMap) {
  // The mean of opposite places of the edge lies straight down, outside of the map.
  PolarMap map = PolarMap::make({50, 90, 100 * kDegree}, 3);
  for (int sector = 0; sector < 90; ++sector)
    set_bin(map, 49, sector, Rgb::Constant(sector % 3 == 0 ? 1.0f : 2.0f));
  for (const int count : {1, 2, 3, 16}) expect_sound(map, method(), count);
}

TEST_P(DecompositionInvariants, BlackMapGivesLightsOfNoPower) {
  for (const PolarGrid& grid : {PolarGrid{45, 180, kPi / 2}, PolarGrid{1, 1, kPi}})
    expect_sound(PolarMap::make(grid, 3), method(), 10);
  EXPECT_TRUE((sum(lights(PolarMap::make({9, 9, kPi}, 3), 10)) == 0).all());
}

TEST_P(DecompositionInvariants, OneBurningBinKeepsItsPowerAndPlace) {
  const PolarGrid grid{45, 180, kPi / 2};
  for (const auto& [ring, sector] : {std::pair{0, 0}, {44, 90}, {20, 0}, {20, 179}}) {
    const PolarMap map = one_bin(grid, ring, sector, 1e8f);
    expect_sound(map, method(), 16);
    const Vec3d place = grid.bin_direction(ring, sector);
    for (const auto& light : lights(map, 16).lights) {
      if (light.illuminance.maxCoeff() <= 0) continue;
      const double degrees = std::acos(std::min(1.0, light.direction.cast<double>().dot(place))) / kDegree;
      EXPECT_LT(degrees, GetParam().place_deg) << ring << " " << sector;
    }
  }
}

TEST_P(DecompositionInvariants, SunOf1e8AtPoleHorizonAndSeamKeepsItsPowerBesideTheSky) {
  const PolarGrid grid{45, 180, kPi / 2};
  for (const auto& [ring, sector] : {std::pair{0, 0}, {44, 90}, {20, 0}, {20, 179}}) {
    PolarMap map = outdoor(grid);
    const double sky = luminance(total_illuminance(map));
    set_bin(map, ring, sector, Rgb::Constant(1e8f));
    expect_sound(map, method(), 32);
    const Vec3d place = grid.bin_direction(ring, sector);
    double beside = 0;
    for (const auto& light : lights(map, 32).lights) {
      const double degrees = std::acos(std::min(1.0, light.direction.cast<double>().dot(place))) / kDegree;
      if (degrees > GetParam().place_deg) beside += luminance(light.illuminance.cast<double>().eval());
    }
    // Lights beside it have the sky's power; a ten thousandth of the sun's may go where powers are matched.
    EXPECT_LT(beside, sky + 1e-4 * luminance(total_illuminance(map))) << ring << " " << sector;
  }
}

TEST_P(DecompositionInvariants, ScaleOfTheLightScalesThePowersOnly) {
  const PolarMap map = outdoor({30, 90, kPi / 2});
  const LightSet plain = lights(map, 32);
  for (const float factor : {0x1p-90f, 0x1p80f}) {  // 1e-27 and 1e24, exact in binary
    const LightSet other = lights(scaled(map, factor), 32);
    for (std::size_t i = 0; i < plain.lights.size(); ++i) {
      EXPECT_LT((plain.lights[i].direction - other.lights[i].direction).norm(), 1e-4f);
      const Rgb expected = plain.lights[i].illuminance * factor;
      EXPECT_TRUE(((other.lights[i].illuminance - expected).abs() <= 1e-4f * expected.maxCoeff()).all());
    }
  }
  for (const float factor : {1e-30f, 1e25f}) expect_sound(scaled(map, factor), method(), 32);
}

TEST_P(DecompositionInvariants, RangeOf1e8IsSound) {
  PolarMap wide = outdoor({30, 90, kPi / 2});
  wide.plane(1)[1000] = 1e8f;
  expect_sound(wide, method(), 32);
}

TEST_P(DecompositionInvariants, RedLightStaysRed) {
  PolarMap map = outdoor({30, 90, kPi / 2});
  std::fill(map.plane(1).begin(), map.plane(1).end(), 0.0f);
  std::fill(map.plane(2).begin(), map.plane(2).end(), 0.0f);
  expect_sound(map, method(), 20);
  for (const auto& light : lights(map, 20).lights)
    EXPECT_TRUE(light.illuminance[1] == 0 && light.illuminance[2] == 0);
}

TEST_P(DecompositionInvariants, MonochromeMapsGiveGreyLights) {
  PolarMap map = PolarMap::make({12, 30, kPi / 2}, 1);
  for (std::size_t i = 0; i < map.radiance.size(); ++i) map.radiance[i] = static_cast<float>(i % 7);
  for (const auto& light : lights(map, 9).lights)
    EXPECT_LT((light.illuminance - light.illuminance[0]).abs().maxCoeff(),
              1e-5f * (1 + light.illuminance[0]));
}

TEST_P(DecompositionInvariants, FewerLitBinsThanLightsIsSound) {
  PolarMap map = one_bin({45, 180, kPi / 2}, 10, 20, 5);
  map.plane(0)[7000] = 3;
  map.plane(2)[1234] = 1;
  expect_sound(map, method(), 64);
}

TEST_P(DecompositionInvariants, WhatIsNoRadianceCountsAsBlack) {
  PolarMap map = outdoor({30, 90, kPi / 2});
  PolarMap black = map;
  const float none[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                        -std::numeric_limits<float>::infinity(), -1e20f, -1e-20f};
  for (std::size_t i = 0; i < 5; ++i)
    for (const std::size_t bin : {100 * i, 100 * i + 2700, 100 * i + 5401}) {
      map.radiance[bin] = none[i];
      black.radiance[bin] = 0;
    }
  const LightSet a = lights(map, 24);
  const LightSet b = lights(black, 24);
  for (std::size_t i = 0; i < a.lights.size(); ++i) {
    EXPECT_EQ(a.lights[i].direction, b.lights[i].direction);
    EXPECT_TRUE((a.lights[i].illuminance == b.lights[i].illuminance).all());
  }
}

TEST_P(DecompositionInvariants, SameMapSameLights) {
  const PolarMap map = outdoor({45, 180, kPi / 2});
  const LightSet a = lights(map, 48);
  const LightSet b = lights(map, 48);
  for (std::size_t i = 0; i < a.lights.size(); ++i) {
    EXPECT_EQ(a.lights[i].direction, b.lights[i].direction);
    EXPECT_TRUE((a.lights[i].illuminance == b.lights[i].illuminance).all());
    EXPECT_EQ(a.lights[i].parent, b.lights[i].parent);
  }
}

// No method's lights turn exactly: bins that lie exactly between two places, and grids that the method is laid on,
// decide by rounding or by the grid. The set is as good as before.
TEST_P(DecompositionInvariants, LightsOfATurnedMapAreAsGood) {
  const PolarMap map = outdoor({45, 180, kPi / 2});
  for (const int count : {16, 64}) {
    const LightError error = LightEvaluator(map).error(lights(map, count));
    for (const int by : {45, 7, 90, 133}) {
      const PolarMap other = turned(map, by);
      EXPECT_LT(apart(LightEvaluator(other).error(lights(other, count)), error), GetParam().rotation)
          << count << " lights, turned by " << by << " sectors";
    }
  }
}

TEST_P(DecompositionInvariants, TwiceTheResolutionIsNoWorldOfDifference) {
  const PolarMap fine = outdoor({90, 360, kPi / 2});
  const LightEvaluator evaluator(fine);
  for (const int count : {16, 64})
    EXPECT_LT(apart(evaluator.error(lights(fine, count)), evaluator.error(lights(halved(fine), count))),
              GetParam().resolution)
        << count;
}

TEST_P(DecompositionInvariants, TheFirstLightsAreAGoodSetByThemselves) {
  const PolarMap map = outdoor({90, 360, kPi / 2});
  const LightEvaluator evaluator(map);
  const double own = evaluator.error(lights(map, 16)).shadow_rel_rmse;
  EXPECT_LT(evaluator.error(take_lights(lights(map, 64), 16)).shadow_rel_rmse, GetParam().prefix * own);
}

}  // namespace lightwell::test
