// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/decompose.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <tuple>

#include "lighting/evaluation/evaluate.h"

namespace lightwell {
namespace {

constexpr double kDegree = kPi / 180;

// A gradient, a sun and some texture.
PolarMap outdoor(const PolarGrid& grid) {
  PolarMap map = PolarMap::make(grid, 3);
  std::mt19937 generator(8);
  std::uniform_real_distribution<float> texture(0.5f, 1.5f);
  const Vec3d sun = direction_from_spherical({40 * kDegree, 100 * kDegree});
  std::size_t bin = 0;
  for (int ring = 0; ring < grid.rings; ++ring)
    for (int sector = 0; sector < grid.sectors; ++sector, ++bin) {
      const Vec3d d = grid.bin_direction(ring, sector);
      const Rgb sky = Rgb(0.2f, 0.4f, 0.8f) * (1.2f + static_cast<float>(d.y())) * texture(generator);
      const Rgb value = sky + (d.dot(sun) > std::cos(3 * kDegree) ? Rgb(300, 280, 240) : Rgb(0, 0, 0));
      for (int c = 0; c < 3; ++c) map.plane(c)[bin] = value[c];
    }
  return map;
}

PolarMap scaled(PolarMap map, float factor) {
  for (float& value : map.radiance) value *= factor;
  return map;
}

PolarMap one_bin(const PolarGrid& grid, int ring, int sector, float value) {
  PolarMap map = PolarMap::make(grid, 3);
  for (int c = 0; c < 3; ++c) map.plane(c)[static_cast<std::size_t>(ring * grid.sectors + sector)] = value;
  return map;
}

Rgbd sum(const LightSet& set) {
  Rgbd total = Rgbd::Zero();
  for (const auto& light : set.lights) total += light.illuminance.cast<double>();
  return total;
}

// What every method promises for every map.
void expect_sound(const PolarMap& map, Method method, int count) {
  const auto result = decompose(map, method, count);
  ASSERT_TRUE(result) << result.error().message;
  const LightSet& set = *result;
  const std::string what = std::string(name(method)) + " " + std::to_string(count);
  ASSERT_EQ(set.lights.size(), static_cast<std::size_t>(count)) << what;
  const Rgbd total = total_illuminance(map);
  for (std::size_t i = 0; i < set.lights.size(); ++i) {
    const DirectionalLight& light = set.lights[i];
    EXPECT_NEAR(light.direction.cast<double>().norm(), 1, 1e-6) << what;  // float rounding
    EXPECT_TRUE(light.illuminance.isFinite().all() && (light.illuminance >= 0).all()) << what;
    EXPECT_GE(light.direction.cast<double>().y(), std::cos(map.grid.theta_max_rad) - 1e-6) << what;
    if (!set.has_parents) continue;
    const bool earlier = light.parent >= 0 && light.parent < static_cast<int>(i);
    EXPECT_TRUE(i == 0 ? light.parent == -1 : earlier) << what;
  }
  const double largest = std::max(total.maxCoeff(), 1e-300);
  if (!sampler_of(method)) {
    // float rounding of `count` lights
    EXPECT_LT((sum(set) - total).abs().maxCoeff() / largest, 1e-6) << what;
  } else if (total.maxCoeff() > 0) {
    EXPECT_NEAR(luminance(sum(set)) / luminance(total), 1, 1e-4) << what;
  }
}

class EveryMethod : public testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(Decompose, EveryMethod, testing::ValuesIn(kMethods), [](const auto& method) {
  std::string text(name(method.param));
  std::replace(text.begin(), text.end(), '-', '_');
  return text;
});

TEST_P(EveryMethod, IsSoundForAnyCountGridAndCoverage) {
  for (const PolarGrid& grid : {PolarGrid{45, 180, kPi / 2}, PolarGrid{37, 61, kPi}, PolarGrid{1, 1, kPi / 2},
                                PolarGrid{1, 2, kPi}, PolarGrid{20, 64, 93 * kDegree}})
    for (const int count : {1, 2, 3, 16, 65}) expect_sound(outdoor(grid), GetParam(), count);
}

TEST_P(EveryMethod, IsSoundForManyLights) {
  expect_sound(outdoor({90, 360, kPi / 2}), GetParam(), 3000);
}

TEST_P(EveryMethod, BlackMapGivesLightsOfNoPower) {
  for (const PolarGrid& grid : {PolarGrid{45, 180, kPi / 2}, PolarGrid{1, 1, kPi}})
    expect_sound(PolarMap::make(grid, 3), GetParam(), 10);
  EXPECT_TRUE((sum(*decompose(PolarMap::make({9, 9, kPi}, 3), GetParam(), 10)) == 0).all());
}

TEST_P(EveryMethod, OneBurningBinAtPoleHorizonAndSeamKeepsItsPowerAndPlace) {
  const PolarGrid grid{45, 180, kPi / 2};
  for (const auto& [ring, sector] : {std::pair{0, 0}, {44, 90}, {20, 0}, {20, 179}}) {
    const PolarMap map = one_bin(grid, ring, sector, 1e8f);
    expect_sound(map, GetParam(), 16);
    const LightSet set = decompose(map, GetParam(), 16).value();
    const Vec3d place = grid.bin_direction(ring, sector);
    for (const auto& light : set.lights) {
      if (light.illuminance.maxCoeff() <= 0 || GetParam() == Method::uniform) continue;
      // Samplers spread lights over the bin, 2° x 2° (and beside it in azimuth at the pole's own ring).
      const double degrees = std::acos(std::min(1.0, light.direction.cast<double>().dot(place))) / kDegree;
      EXPECT_LT(degrees, sampler_of(GetParam()) ? 4.0 : 0.05)
          << name(GetParam()) << " " << ring << " " << sector;
    }
  }
}

TEST_P(EveryMethod, RangeAndScaleOfTheLightDoNotMatter) {
  PolarMap wide = outdoor({30, 90, kPi / 2});
  wide.plane(1)[1000] = 1e8f;
  expect_sound(wide, GetParam(), 32);
  const PolarMap map = outdoor({30, 90, kPi / 2});
  const LightSet plain = decompose(map, GetParam(), 32).value();
  for (const float factor : {0x1p-90f, 0x1p80f}) {  // 1e-27 and 1e24, exact in binary
    expect_sound(scaled(map, factor), GetParam(), 32);
    const LightSet other = decompose(scaled(map, factor), GetParam(), 32).value();
    for (std::size_t i = 0; i < plain.lights.size(); ++i)
      EXPECT_LT((plain.lights[i].direction - other.lights[i].direction).norm(), 1e-4f) << name(GetParam());
  }
}

TEST_P(EveryMethod, RedLightStaysRed) {
  PolarMap map = outdoor({30, 90, kPi / 2});
  std::fill(map.plane(1).begin(), map.plane(1).end(), 0.0f);
  std::fill(map.plane(2).begin(), map.plane(2).end(), 0.0f);
  expect_sound(map, GetParam(), 20);
  const LightSet set = decompose(map, GetParam(), 20).value();
  for (const auto& light : set.lights) EXPECT_TRUE(light.illuminance[1] == 0 && light.illuminance[2] == 0);
}

TEST_P(EveryMethod, MonochromeMapsGiveGreyLights) {
  PolarMap map = PolarMap::make({12, 30, kPi / 2}, 1);
  for (std::size_t i = 0; i < map.radiance.size(); ++i) map.radiance[i] = static_cast<float>(i % 7);
  const LightSet set = decompose(map, GetParam(), 9).value();
  for (const auto& light : set.lights)
    EXPECT_LT((light.illuminance - light.illuminance[0]).abs().maxCoeff(),
              1e-5f * (1 + light.illuminance[0]));
}

TEST_P(EveryMethod, FewerLitBinsThanLightsIsSound) {
  PolarMap map = one_bin({45, 180, kPi / 2}, 10, 20, 5);
  map.plane(0)[7000] = 3;
  map.plane(2)[1234] = 1;
  expect_sound(map, GetParam(), 64);
}

TEST(Decompose, NamesGoThereAndBack) {
  for (const Method method : kMethods) EXPECT_EQ(method_from_name(name(method)), method);
  EXPECT_FALSE(method_from_name("penrose"));
}

TEST(Decompose, CountOutOfRangeIsWrongUsageAndOverflowBadInput) {
  const PolarMap map = outdoor({4, 8, kPi});
  for (const int count : {0, -5, kMostLights + 1})
    EXPECT_EQ(decompose(map, Method::best, count).error().kind, ErrorKind::usage);
  PolarMap huge = map;
  for (float& value : huge.radiance) value = 3e38f;
  EXPECT_EQ(decompose(huge, Method::best, 4).error().kind, ErrorKind::bad_input);
}

TEST(Decompose, AHundredThousandLightsOfOnePixel) {
  for (const Method method : kMethods) expect_sound(outdoor({1, 1, kPi / 2}), method, 100000);
}

TEST(BestLights, FewLitBinsAreExactLights) {
  PolarMap map = one_bin({45, 180, kPi / 2}, 10, 20, 5);
  map.plane(0)[7000] = 3;
  const LightSet set = decompose(map, Method::best, 8).value();
  const LightError error = LightEvaluator(map).error(set);
  EXPECT_LT(error.irradiance_rel_rmse, 1e-6);  // float directions
}

TEST(BestLights, BeatsEveryOtherMethodHere) {
  const PolarMap map = outdoor({90, 360, kPi / 2});
  const LightEvaluator evaluator(map);
  for (const int count : {4, 16, 64}) {
    const LightError best = evaluator.error(*decompose(map, Method::best, count));
    for (const Method method : kMethods) {
      if (method == Method::best) continue;
      const LightError other = evaluator.error(*decompose(map, method, count));
      EXPECT_LT(best.irradiance_rel_rmse, other.irradiance_rel_rmse) << name(method) << " " << count;
      EXPECT_LT(best.shadow_rel_rmse, other.shadow_rel_rmse) << name(method) << " " << count;
    }
  }
}

TEST(BestLights, EveryCutOfTheSetIsBetterThanHalfAsManyByMedianCut) {
  const PolarMap map = outdoor({90, 360, kPi / 2});
  const LightEvaluator evaluator(map);
  const LightSet set = decompose(map, Method::best, 64).value();
  for (const int count : {8, 16, 32, 48})
    EXPECT_LT(evaluator.error(take_lights(set, static_cast<std::size_t>(count))).shadow_rel_rmse,
              evaluator.error(*decompose(map, Method::median_cut, count / 2)).shadow_rel_rmse)
        << count;
}

TEST(MedianCut, PowersOfTwoAreNearlyEqualAndHalvesNest) {
  const PolarMap map = scaled(PolarMap::make({64, 256, kPi / 2}, 3), 0);
  PolarMap flat = map;
  for (float& value : flat.radiance) value = 1;
  const LightSet set = decompose(flat, Method::median_cut, 16).value();
  const double share = luminance(total_illuminance(flat)) / 16;
  // A cut falls between rows or columns: of the 64 x 256 bins a half is off by at most one row in 16, four
  // times over.
  for (const auto& light : set.lights)
    EXPECT_NEAR(luminance(light.illuminance.cast<double>().eval()) / share, 1, 0.2);
  const LightSet four = decompose(flat, Method::median_cut, 4).value();
  const LightSet folded = take_lights(set, 4);
  for (std::size_t i = 0; i < 4; ++i) {
    // The same regions. A fold weighs unit vectors, though the mean of a wide region is shorter than of a
    // narrow one: by a 24th of its width squared, up to 0.7 % for widths of 0.4, of lights 0.4 apart.
    EXPECT_LT((four.lights[i].direction - folded.lights[i].direction).norm(), 0.003f);
    EXPECT_NEAR(four.lights[i].illuminance[0], folded.lights[i].illuminance[0], 1e-4);
  }
}

TEST(UniformLights, CellsOfAConstantMapHaveEqualPower) {
  PolarMap map = PolarMap::make({360, 720, kPi}, 1);
  for (float& value : map.radiance) value = 1;
  for (const int count : {1, 2, 5, 24, 100}) {
    const LightSet set = decompose(map, Method::uniform, count).value();
    for (const auto& light : set.lights)  // whole bins of 0.5°, against cells of 20° and more
      EXPECT_NEAR(light.illuminance[0] * static_cast<float>(count) / (4 * kPi), 1, 0.06) << count;
  }
}

}  // namespace
}  // namespace lightwell
