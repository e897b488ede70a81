// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/fit/lambertian_probe.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/allocation_counter.h"
#include "tests/support/sampling_maps.h"

namespace lightwell {
namespace {

// Bin by bin, face by face.
ProbeIrradiance brute_force(const PolarMap& map) {
  const ProbeNormals normals = probe_normals();
  ProbeIrradiance sum = ProbeIrradiance::Zero();
  for (int ring = 0; ring < map.grid.rings; ++ring)
    for (int sector = 0; sector < map.grid.sectors; ++sector) {
      const auto bin = static_cast<std::size_t>(ring * map.grid.sectors + sector);
      const Vec3d d = map.grid.bin_direction(ring, sector);
      const Rgbd light = map.rgb(bin).cast<double>() * static_cast<double>(map.solid_angle_sr[bin]);
      for (int i = 0; i < kProbeNormals; ++i)
        sum.row(i) += light.transpose() * std::max(0.0, normals.col(i).dot(d));
    }
  return sum;
}

TEST(LambertianProbe, NormalsAreTheFacesOfAnIcosahedronDividedTwiceInOppositePairs) {
  const ProbeNormals normals = probe_normals();
  for (int i = 0; i < kProbeNormals; ++i) {
    EXPECT_NEAR(normals.col(i).norm(), 1, 1e-15);
    double nearest = -1;
    for (int j = 0; j < kProbeNormals; ++j)
      if (j != i) nearest = std::max(nearest, normals.col(i).dot(normals.col(j)));
    // 320 faces of 4π/320 sr: neighbours' centres are 8 to 14 degrees apart.
    EXPECT_LT(nearest, std::cos(6 * kPi / 180));
    EXPECT_GT(nearest, std::cos(16 * kPi / 180));
  }
  for (int i = 0; i < kProbeNormals / 2; ++i)
    EXPECT_EQ(Vec3d(normals.col(i + kProbeNormals / 2)), Vec3d(-normals.col(i)));
  EXPECT_LT(normals.rowwise().mean().norm(), 1e-15);
}

TEST(LambertianProbe, EqualsASumOverEveryBin) {
  for (const auto& [name, map] : test::hard_maps()) {
    LambertianProbe probe(map.grid);
    ProbeIrradiance irradiance;
    probe.irradiance(map, irradiance);
    const ProbeIrradiance expected = brute_force(map);
    // Rounding of running sums in double, against the brightest face: the faces that a sun of 1e8 does not reach are
    // differences of large sums.
    EXPECT_LT((irradiance - expected).abs().maxCoeff(), 1e-12 * expected.maxCoeff()) << name;
    EXPECT_LT((probe.total_illuminance() - total_illuminance(map)).abs().maxCoeff(),
              1e-6 * total_illuminance(map).maxCoeff())
        << name;
  }
}

TEST(LambertianProbe, AnEvenSkyOfRadianceOneGivesPi) {
  LambertianProbe probe({180, 360, kPi});
  ProbeIrradiance irradiance;
  probe.irradiance(test::constant_map({180, 360, kPi}, Rgb(1, 1, 1)), irradiance);
  // Bins of one degree as points in their centres: off by half a bin's angle squared, 8e-5.
  EXPECT_LT((irradiance / kPi - 1).abs().maxCoeff(), 8e-5);
}

TEST(LambertianProbe, WhatIsNoLightCountsAsZero) {
  const PolarGrid grid{18, 36, kPi};
  PolarMap map = test::random_map(grid, 3);
  PolarMap clean = map;
  std::size_t bin = 40;
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -3.0f}) {
    map.radiance[bin] = bad;
    clean.radiance[bin] = 0;
    bin += 50;
  }
  LambertianProbe probe(grid);
  ProbeIrradiance irradiance, expected;
  probe.irradiance(map, irradiance);
  probe.irradiance(clean, expected);
  EXPECT_TRUE((irradiance == expected).all());
}

TEST(LambertianProbe, AllocatesNothing) {
  const PolarMap map = test::random_map({90, 360, kPi / 2}, 1);
  LambertianProbe probe(map.grid);
  ProbeIrradiance irradiance;
  const test::AllocationCounter counter;
  probe.irradiance(map, irradiance);
  EXPECT_EQ(counter.count(), 0u);
}

}  // namespace
}  // namespace lightwell
