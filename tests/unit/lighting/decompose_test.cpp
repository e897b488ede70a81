// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/decompose.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lighting/evaluation/evaluate.h"
#include "tests/support/decomposition_maps.h"

namespace lightwell {
namespace {

using test::one_bin;
using test::outdoor;
using test::scaled;

TEST(Decompose, NamesGoThereAndBack) {
  for (const Method method : kMethods) EXPECT_EQ(method_from_name(name(method)), method);
  EXPECT_FALSE(method_from_name("monte-carlo"));
}

TEST(Decompose, CountOutOfRangeIsWrongUsageAndOverflowBadInput) {
  const PolarMap map = outdoor({4, 8, kPi});
  for (const int count : {0, -5, kMostLights + 1})
    EXPECT_EQ(decompose(map, Method::best, count).error().kind, ErrorKind::usage);
  PolarMap huge = map;
  for (float& value : huge.radiance) value = 3e38f;
  EXPECT_EQ(decompose(huge, Method::best, 4).error().kind, ErrorKind::bad_input);
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

// Independent: every bin in a list, sorted and divided by recursion as the paper has it; no table of sums.
struct MedianBin {
  int ring, sector;
  Vec3d direction;
  Rgbd light;
};

void median_cut_of(std::vector<MedianBin> region, int divisions, const PolarGrid& grid, LightSet& set) {
  int ring0 = grid.rings, ring1 = 0, sector0 = grid.sectors, sector1 = 0;
  Rgbd light = Rgbd::Zero();
  Vec3d moment = Vec3d::Zero();
  for (const MedianBin& b : region) {
    ring0 = std::min(ring0, b.ring);
    ring1 = std::max(ring1, b.ring + 1);
    sector0 = std::min(sector0, b.sector);
    sector1 = std::max(sector1, b.sector + 1);
    light += b.light;
    moment += luminance(b.light) * b.direction;
  }
  if (divisions == 0) {
    set.lights.push_back({moment.normalized().cast<float>(), light.cast<float>(), -1, 0});
    return;
  }
  const double height = grid.theta_max_rad * (ring1 - ring0) / grid.rings;
  const double width = 2 * kPi * (sector1 - sector0) / grid.sectors *
                       std::sin(grid.theta_max_rad * (ring0 + ring1) / (2.0 * grid.rings));
  const bool across_rings = height >= width;
  const auto place = [&](const MedianBin& b) { return across_rings ? b.ring : b.sector; };
  // Of all straight cuts the one with the most even halves.
  int best = 0;
  double least = 1e300;
  for (int cut = (across_rings ? ring0 : sector0) + 1; cut < (across_rings ? ring1 : sector1); ++cut) {
    double before = 0;
    for (const MedianBin& b : region)
      if (place(b) < cut) before += luminance(b.light);
    const double uneven = std::abs(2 * before - luminance(light));
    if (uneven < least) {
      least = uneven;
      best = cut;
    }
  }
  std::vector<MedianBin> halves[2];
  for (const MedianBin& b : region) halves[place(b) < best ? 0 : 1].push_back(b);
  for (const auto& half : halves) median_cut_of(half, divisions - 1, grid, set);
}

TEST(MedianCut, IsAsGoodAsBruteForce) {
  for (const int zenith_angle : {25, 50, 70}) {
    // With the sun at 180° the map is opened at azimuth 0, where the reference's bins begin.
    const PolarMap map = test::sun_and_sky({24, 72, kPi / 2}, 180, zenith_angle, 0.1);
    std::vector<MedianBin> bins;
    for (int ring = 0; ring < 24; ++ring)
      for (int sector = 0; sector < 72; ++sector)
        bins.push_back({ring, sector, map.grid.bin_direction(ring, sector),
                        map.rgb(static_cast<std::size_t>(ring * 72 + sector)).cast<double>() *
                            map.grid.bin_solid_angle_sr(ring)});
    const LightEvaluator evaluator(map);
    for (const int divisions : {2, 4, 5}) {
      LightSet set;
      median_cut_of(bins, divisions, map.grid, set);
      const LightError expected = evaluator.error(set);
      const LightError ours = evaluator.error(*decompose(map, Method::median_cut, 1 << divisions));
      // The same rules: only a cut between two equally even ones may fall the other way.
      EXPECT_NEAR(ours.irradiance_rel_rmse / expected.irradiance_rel_rmse, 1, 0.05)
          << zenith_angle << " " << divisions;
      EXPECT_NEAR(ours.shadow_rel_rmse / expected.shadow_rel_rmse, 1, 0.05)
          << zenith_angle << " " << divisions;
    }
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
