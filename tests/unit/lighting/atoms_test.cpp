// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/atoms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace lightwell {
namespace {

Atoms atoms_of(const PolarMap& map, int lights = 64) {
  AtomMaker maker(map.grid, lights);
  Atoms atoms(maker.capacity());
  maker.make(map, atoms);
  return atoms;
}

Rgbd sum(const Atoms& atoms) {
  Rgbd total = Rgbd::Zero();
  for (int k = 0; k < atoms.count; ++k) total += atoms.weight_of(k);
  return total;
}

PolarMap noisy(const PolarGrid& grid) {
  PolarMap map = PolarMap::make(grid, 3);
  std::mt19937 generator(1);
  std::uniform_real_distribution<float> exponent(-3, 1);
  for (float& value : map.radiance) value = std::pow(10.0f, exponent(generator));
  map.plane(0)[5 % grid.size()] = 1e6f;
  return map;
}

TEST(Atoms, KeepTheMapsPowerAndItsMeanDirection) {
  for (const PolarGrid& grid :
       {PolarGrid{90, 360, kPi / 2}, PolarGrid{256, 1024, kPi / 2}, PolarGrid{180, 360, kPi},
        PolarGrid{37, 61, kPi}, PolarGrid{1, 1, kPi / 2}, PolarGrid{3, 500, kPi / 2}}) {
    const PolarMap map = noisy(grid);
    const Atoms atoms = atoms_of(map);
    const Rgbd total = total_illuminance(map);
    EXPECT_LT(((atoms.total - total) / total).abs().maxCoeff(), 1e-6);  // floats over a block's rings
    EXPECT_LT(((sum(atoms) * atoms.scale - total) / total).abs().maxCoeff(), 1e-5);  // floats, some thousand
    EXPECT_LE(atoms.count, atoms.capacity());
    Vec3d moment = Vec3d::Zero(), expected = Vec3d::Zero();
    for (int k = 0; k < atoms.count; ++k) {
      moment += atoms.direction(k) * luminance(atoms.weight_of(k));
      EXPECT_NEAR(atoms.direction(k).norm(), 1, 1e-6);
    }
    std::size_t bin = 0;
    for (int ring = 0; ring < grid.rings; ++ring)
      for (int sector = 0; sector < grid.sectors; ++sector, ++bin)
        expected += grid.bin_direction(ring, sector) *
                    luminance((map.rgb(bin) * map.solid_angle_sr[bin]).cast<double>().eval()) /
                    luminance(total);
    // An atom stands for its bins' mean direction, made unit: blocks are 12° wide.
    if (grid.size() > 1000) {
      EXPECT_LT((moment - expected).norm(), 0.01);
    }
  }
}

TEST(Atoms, AreFewWhereTheLightIsEven) {
  PolarMap map = PolarMap::make({90, 360, kPi / 2}, 1);
  std::fill(map.radiance.begin(), map.radiance.end(), 1.0f);
  EXPECT_LT(atoms_of(map).count, 2000);
  EXPECT_GT(atoms_of(map).count, 300);
}

TEST(Atoms, OneBurningBinKeepsItsPlace) {
  for (const int sector : {0, 333, 1023}) {
    PolarMap map = PolarMap::make({256, 1024, kPi / 2}, 1);
    std::fill(map.radiance.begin(), map.radiance.end(), 1.0f);
    map.radiance[static_cast<std::size_t>(100 * 1024 + sector)] = 1e7f;
    const Atoms atoms = atoms_of(map);
    const auto brightest =
        std::max_element(atoms.luminance.begin(), atoms.luminance.end()) - atoms.luminance.begin();
    EXPECT_LT((atoms.direction(static_cast<int>(brightest)) - map.grid.bin_direction(100, sector)).norm(),
              1e-5);
  }
}

TEST(Atoms, WhatIsNotLightCountsAsNone) {
  PolarMap map = PolarMap::make({10, 10, kPi / 2}, 1);
  map.radiance[3] = -1;
  map.radiance[4] = std::nanf("");
  map.radiance[5] = INFINITY;
  EXPECT_EQ(atoms_of(map).count, 0);
  EXPECT_EQ(atoms_of(map).scale, 0);
  map.radiance[6] = 2;
  EXPECT_EQ(atoms_of(map).count, 1);
}

TEST(Atoms, ScaleOfTheLightIsNothingToThem) {
  const PolarMap map = noisy({45, 180, kPi / 2});
  const Atoms plain = atoms_of(map);
  for (const float factor : {0x1p-90f, 0x1p60f}) {
    PolarMap other = map;
    for (float& v : other.radiance) v *= factor;
    const Atoms scaled = atoms_of(other);
    ASSERT_EQ(scaled.count, plain.count);
    EXPECT_NEAR(scaled.scale / plain.scale, static_cast<double>(factor), 1e-6 * static_cast<double>(factor));
    for (std::size_t k = 0; k < static_cast<std::size_t>(plain.count); ++k)
      EXPECT_NEAR(static_cast<double>(scaled.luminance[k]), static_cast<double>(plain.luminance[k]), 1e-7);
  }
}

TEST(Atoms, MergedStandForAll) {
  const Atoms atoms = atoms_of(noisy({90, 360, kPi / 2}));
  for (const int count : {1, 7, 100, 5000}) {
    const Atoms merged = merge_atoms(atoms, count);
    EXPECT_EQ(merged.count, std::min(count, atoms.count));
    EXPECT_LT((sum(merged) - sum(atoms)).abs().maxCoeff(), 1e-5);
  }
}

}  // namespace
}  // namespace lightwell
