// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/voronoi_cells.h"

#include <gtest/gtest.h>

#include <random>

#include "lighting/decomposition/cell_powers.h"
#include "tests/support/decomposition_maps.h"

namespace lightwell {
namespace {

Vec3d random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Vec3d d;
  do {
    d = {normal(random), normal(random), normal(random)};
  } while (d.norm() < 1e-3);
  return d.normalized();
}

// Independent and slow: every bin against every place.
void expect_nearest(const LitBins& bins, const VoronoiCells& cells, const std::vector<Vec3d>& places) {
  for (std::size_t i = 0; i < bins.size(); ++i) {
    double nearest = 9;
    for (const Vec3d& p : places) nearest = std::min(nearest, (bins.direction[i] - p).norm());
    // Two places as near as rounding can tell are both right.
    ASSERT_NEAR((bins.direction[i] - places[cells.cell(i)]).norm(), nearest, 1e-12);
    ASSERT_NEAR(cells.cosine(i), bins.direction[i].dot(places[cells.cell(i)]), 1e-15);
  }
}

TEST(LitBins, HoldTheMapsLightAndNothingElse) {
  for (const auto& [name, map] : test::hard_maps()) {
    const LitBins bins = lit_bins(map);
    double power = 0;
    std::vector<bool> seen(map.grid.size(), false);
    for (std::size_t i = 0; i < bins.size(); ++i) {
      power += bins.power[i];
      const auto sectors = static_cast<std::uint32_t>(map.grid.sectors);
      const Vec3d direction = map.grid.bin_direction(static_cast<int>(bins.bin[i] / sectors),
                                                     static_cast<int>(bins.bin[i] % sectors));
      EXPECT_LT((bins.direction[i] - direction).norm(), 1e-14) << name;  // rounding
      seen[bins.bin[i]] = true;
    }
    EXPECT_NEAR(power, 1, 1e-12) << name;
    for (std::size_t bin = 0; bin < seen.size(); ++bin)
      EXPECT_EQ(seen[bin], map.rgb(bin).maxCoeff() > 0) << name << " " << bin;
    for (const LitBins::Block& block : bins.blocks)
      for (std::size_t i = block.begin; i < block.end; ++i)
        EXPECT_LE((bins.direction[i] - block.centre).norm(), block.radius) << name;
  }
  EXPECT_TRUE(lit_bins(PolarMap::make({5, 6, kPi}, 3)).empty());
}

TEST(VoronoiCells, EveryBinIsOfItsNearestPlaceWhileSomeAreAddedAndSomeMove) {
  std::mt19937 random(3);
  for (const PolarGrid& grid : {PolarGrid{45, 180, kPi / 2}, PolarGrid{30, 64, kPi}, PolarGrid{1, 1, kPi}}) {
    const PolarMap map = test::random_map(grid, 5);
    const LitBins bins = lit_bins(map);
    VoronoiCells cells(bins);
    std::vector<Vec3d> places;
    std::vector<std::uint32_t> followed(bins.size(), VoronoiCells::kNone);
    const auto follow = [&](std::span<const VoronoiCells::Change> changes) {
      for (const VoronoiCells::Change& c : changes) {
        EXPECT_EQ(followed[c.bin], c.from);
        followed[c.bin] = c.to;
      }
    };
    for (int step = 0; step < 60; ++step) {
      places.push_back(random_direction(random));
      follow(cells.add(places.back()));
      std::vector<VoronoiCells::Move> moves;
      for (std::uint32_t p = 0; p < places.size(); ++p)
        if (random() % 5 == 0)
          moves.push_back({p, (places[p] + 0.3 * random_direction(random)).normalized()});
      for (const auto& m : moves) places[m.place] = m.to;
      follow(cells.move(moves));
      if (step % 10 == 9) expect_nearest(bins, cells, places);
    }
    for (std::size_t i = 0; i < bins.size(); ++i) EXPECT_EQ(followed[i], cells.cell(i));
    VoronoiCells anew(bins);
    anew.assign(places);
    expect_nearest(bins, anew, places);
  }
}

TEST(VoronoiCells, OfEquallyNearPlacesTheFirstHasTheBin) {
  const PolarMap map = test::constant_map({20, 40, kPi / 2}, Rgb::Constant(1));
  const LitBins bins = lit_bins(map);
  const std::vector<Vec3d> places(5, Vec3d(0, 1, 0));
  VoronoiCells cells(bins);
  cells.assign(places);
  for (std::size_t i = 0; i < bins.size(); ++i) EXPECT_EQ(cells.cell(i), 0u);
}

TEST(CellPowers, AreTheLightNearestToEach) {
  std::mt19937 random(4);
  for (const auto& [name, map] : test::hard_maps()) {
    std::vector<DirectionalLight> lights(17);
    for (auto& light : lights) light.direction = random_direction(random).cast<float>();
    set_cell_powers(map, lights);
    std::vector<Rgbd> expected(lights.size(), Rgbd::Zero());
    for (int ring = 0; ring < map.grid.rings; ++ring)
      for (int sector = 0; sector < map.grid.sectors; ++sector) {
        const auto bin = static_cast<std::size_t>(ring * map.grid.sectors + sector);
        std::size_t nearest = 0;
        double least = 9;
        for (std::size_t i = 0; i < lights.size(); ++i) {
          const double d =
              (lights[i].direction.cast<double>().normalized() - map.grid.bin_direction(ring, sector)).norm();
          if (d < least) {
            least = d;
            nearest = i;
          }
        }
        expected[nearest] += map.rgb(bin).cast<double>() * static_cast<double>(map.solid_angle_sr[bin]);
      }
    const double total = total_illuminance(map).maxCoeff();
    for (std::size_t i = 0; i < lights.size(); ++i)
      EXPECT_LT((lights[i].illuminance.cast<double>() - expected[i]).abs().maxCoeff() / total, 1e-7)
          << name;  // float rounding
  }
}

TEST(EqualPowers, LightsAreAlikeInLuminanceAndKeepTheirColour) {
  const PolarMap map = test::constant_map({20, 40, kPi / 2}, Rgb(1, 2, 3));
  std::vector<DirectionalLight> lights(8);
  for (std::size_t i = 0; i < 8; ++i) lights[i].illuminance = Rgb(1, 2, 3) * static_cast<float>(i + 1);
  set_equal_powers(map, lights);
  for (const auto& light : lights)
    EXPECT_LT((light.illuminance.cast<double>() - total_illuminance(map) / 8).abs().maxCoeff(), 1e-5);
}

TEST(EqualPowers, AChannelThatTheLightsLackIsSpreadNotLost) {
  PolarMap map = test::constant_map({20, 40, kPi / 2}, Rgb(1, 0, 0));
  test::set_bin(map, 3, 3, Rgb(0, 0, 5));
  std::vector<DirectionalLight> lights(4);
  for (auto& light : lights) light.illuminance = Rgb(1, 0, 0);
  set_equal_powers(map, lights);
  const Rgbd total = total_illuminance(map);
  for (const auto& light : lights) EXPECT_NEAR(light.illuminance[2], total[2] / 4, 1e-7 * total[0]);
}

}  // namespace
}  // namespace lightwell
