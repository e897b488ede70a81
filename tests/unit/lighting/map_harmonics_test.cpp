// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/map_harmonics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lighting/evaluation/evaluate.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/sampling_maps.h"

namespace lightwell {
namespace {

RadianceHarmonics brute_force(const PolarMap& map) {
  RadianceHarmonics sum = RadianceHarmonics::Zero();
  std::array<double, harmonic_count(kRadianceDegree)> y;
  for (int ring = 0; ring < map.grid.rings; ++ring)
    for (int sector = 0; sector < map.grid.sectors; ++sector) {
      const auto bin = static_cast<std::size_t>(ring * map.grid.sectors + sector);
      const Rgbd light = map.rgb(bin).cast<double>() * static_cast<double>(map.solid_angle_sr[bin]);
      harmonics(map.grid.bin_direction(ring, sector), kRadianceDegree, y.data());
      for (int i = 0; i < sum.rows(); ++i) sum.row(i) += light.transpose() * y[static_cast<std::size_t>(i)];
    }
  return sum;
}

TEST(MapHarmonics, EqualASumOverEveryBin) {
  for (const auto& [name, map] : test::hard_maps()) {
    MapHarmonics project(map.grid);
    const RadianceHarmonics expected = brute_force(map);
    // Rounding of sums in double.
    EXPECT_LT((project.project(map) - expected).abs().maxCoeff(), 1e-13 * expected.abs().maxCoeff()) << name;
  }
}

TEST(MapHarmonics, AnEvenSphereIsAConstant) {
  const PolarGrid grid{90, 180, kPi};
  MapHarmonics project(grid);
  const RadianceHarmonics sky = project.project(test::constant_map(grid, Rgb(1, 2, 3)));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(sky(0, c), (c + 1) * std::sqrt(4 * kPi), 1e-6 * (c + 1));  // floats
  // Bins of 2° as points: half a bin squared, times a curvature of l (l + 1) = 20.
  EXPECT_LT(sky.bottomRows<24>().abs().maxCoeff(), 0.01);
  EXPECT_NEAR(irradiance(sky, Vec3d::UnitX())[1], 2 * kPi, 0.02);
}

// A hemisphere of radiance 1: L_l0 = 2π N_l ∫ P_l over 0 to 1, in closed form; the irradiance of a tilted surface is
// π (1 + cos tilt) / 2.
TEST(MapHarmonics, AnEvenHemisphereIsTheClosedForm) {
  const PolarGrid grid{180, 90, kPi / 2};
  MapHarmonics project(grid);
  const RadianceHarmonics sky = project.project(test::constant_map(grid, Rgb(1, 1, 1)));
  const double integrals[] = {1, 0.5, 0, -0.125, 0};  // of P_0 to P_4
  for (int l = 0; l <= 4; ++l)
    EXPECT_NEAR(sky(harmonic_index(l, 0), 0), 2 * kPi * std::sqrt((2 * l + 1) / (4 * kPi)) * integrals[l],
                1e-3);
  for (const double tilt : {0.0, 0.7, kPi / 2, 2.5, kPi}) {
    const Vec3d normal(std::sin(tilt), std::cos(tilt), 0);
    // It has nothing in the even degrees above 0, so that degree 4 is all of it.
    EXPECT_NEAR(irradiance(sky, normal)[0], kPi * (1 + std::cos(tilt)) / 2, 2e-3);
  }
}

// Against the sum over all bins at 642 normals: beyond degree 4 a single light has .2 % of its irradiance's energy.
TEST(MapHarmonics, IrradianceIsThatOfTheMapButForWhatDegreeFourLeavesOut) {
  const PolarMap map = test::sun_and_sky({90, 360, kPi / 2}, 200, 50, 0.8);
  MapHarmonics project(map.grid);
  const RadianceHarmonics& sky = project.project(map);
  const auto normals = evaluation_normals();
  const LightEvaluator evaluator(map);
  double difference = 0, norm = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    difference += (irradiance(sky, normals[i]) - evaluator.map_irradiance()[i]).square().sum();
    norm += evaluator.map_irradiance()[i].square().sum();
  }
  EXPECT_LT(std::sqrt(difference / norm), 0.045);  // √.002
}

TEST(MapHarmonics, TurningTheMapTurnsEveryOrder) {
  const PolarGrid grid{20, 40, kPi};
  const PolarMap map = test::random_map(grid, 4);
  PolarMap turned = map;
  for (int ring = 0; ring < 20; ++ring)
    for (int sector = 0; sector < 40; ++sector)
      test::set_bin(turned, ring, sector + 5, map.rgb(static_cast<std::size_t>(ring * 40 + sector)));
  MapHarmonics project(grid);
  const RadianceHarmonics before = project.project(map);
  const RadianceHarmonics after = project.project(turned);
  const double angle = 5 * 2 * kPi / 40;
  for (int l = 0; l <= 4; ++l)
    for (int m = 0; m <= l; ++m) {
      const auto cosine = before.row(harmonic_index(l, m)), sine = before.row(harmonic_index(l, -m));
      const Eigen::Array<double, 1, 3> expected =
          m == 0 ? Eigen::Array<double, 1, 3>(cosine)
                 : Eigen::Array<double, 1, 3>(cosine * std::cos(m * angle) - sine * std::sin(m * angle));
      EXPECT_LT((after.row(harmonic_index(l, m)) - expected).abs().maxCoeff(),
                1e-10 * before.abs().maxCoeff());
    }
}

TEST(MapHarmonics, WhatIsNoLightCountsAsZeroAndNothingIsAllocated) {
  PolarMap map = test::random_map({9, 20, kPi / 2}, 6);
  PolarMap clean = map;
  std::size_t bin = 10;
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -3.0f}) {
    map.radiance[bin] = bad;
    clean.radiance[bin] = 0;
    bin += 50;
  }
  MapHarmonics project(map.grid);
  const RadianceHarmonics expected = project.project(clean);
  const test::AllocationCounter counter;
  const RadianceHarmonics& result = project.project(map);
  EXPECT_EQ(counter.count(), 0u);
  EXPECT_TRUE((result == expected).all());
}

}  // namespace
}  // namespace lightwell
