// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/structured_sampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "lighting/decomposition/map_regions.h"
#include "lighting/evaluation/evaluate.h"
#include "tests/support/decomposition_maps.h"

namespace lightwell {
namespace {

struct Bin {
  int ring, sector, layer, label;
  Vec3d direction;
  Rgbd light;
  double solid_angle;
};

// Independent and slow: labels passed on to neighbours until none changes, counts handed out one by one to
// whichever region is owed most, every place compared with every other.
class BruteForce {
 public:
  explicit BruteForce(const PolarMap& map) : grid_(map.grid) {
    double mean = 0, square = 0, solid_angle = 0;
    for (int ring = 0; ring < grid_.rings; ++ring)
      for (int sector = 0; sector < grid_.sectors; ++sector) {
        const auto bin = static_cast<std::size_t>(ring * grid_.sectors + sector);
        const double omega = grid_.bin_solid_angle_sr(ring);
        bins_.push_back({ring, sector, 0, static_cast<int>(bin), grid_.bin_direction(ring, sector),
                         map.rgb(bin).cast<double>() * omega, omega});
        const double height = luminance(map.rgb(bin).cast<double>().eval());
        mean += height * omega;
        square += height * height * omega;
        solid_angle += omega;
      }
    mean /= solid_angle;
    const double sigma = std::sqrt(square / solid_angle - mean * mean);
    for (Bin& b : bins_) b.layer = std::min(5, static_cast<int>(luminance(b.light) / b.solid_angle / sigma));
    for (bool changed = true; changed;) {
      changed = false;
      for (Bin& a : bins_)
        for (Bin& b : bins_)
          if (a.layer == b.layer && neighbours(a, b) && a.label != b.label) {
            a.label = b.label = std::min(a.label, b.label);
            changed = true;
          }
    }
  }

  struct Region {
    int layer = 0;
    double power = 0, solid_angle = 0;
    std::vector<const Bin*> bins;
    int given = 0;
  };

  LightSet lights(int count) {
    std::map<int, Region> by_label;
    double total = 0;
    for (const Bin& b : bins_) {
      Region& r = by_label[b.label];
      r.layer = b.layer;
      r.power += luminance(b.light);
      r.solid_angle += b.solid_angle;
      r.bins.push_back(&b);
    }
    std::vector<Region> regions;
    for (auto& [label, r] : by_label) regions.push_back(r);
    for (const Region& r : regions) total += r.power * std::pow(r.solid_angle, 0.25);
    // Whole shares, then one each to the largest remainders. No region here is smaller than its share.
    int left = count;
    std::vector<std::pair<double, std::size_t>> owed;
    for (std::size_t i = 0; i < regions.size(); ++i) {
      const double share = count * regions[i].power * std::pow(regions[i].solid_angle, 0.25) / total;
      regions[i].given = static_cast<int>(share);
      left -= regions[i].given;
      owed.emplace_back(share - regions[i].given, i);
    }
    std::sort(owed.rbegin(), owed.rend());
    for (int k = 0; k < left; ++k) ++regions[owed[static_cast<std::size_t>(k)].second].given;
    std::sort(regions.begin(), regions.end(), [](const Region& a, const Region& b) {
      return a.layer != b.layer ? a.layer > b.layer : a.power > b.power;
    });
    std::vector<Vec3d> places;
    for (const Region& r : regions)
      for (int k = 0; k < r.given; ++k) places.push_back(k == 0 ? middle(r) : farthest(r, places));
    return of_cells(places);
  }

 private:
  [[nodiscard]] bool neighbours(const Bin& a, const Bin& b) const {
    const int apart = std::abs(a.sector - b.sector);
    if (a.ring == b.ring) return apart == 1 || apart == grid_.sectors - 1 || a.ring == 0;
    return apart == 0 && std::abs(a.ring - b.ring) == 1;
  }
  static Vec3d middle(const Region& r) {
    Vec3d moment = Vec3d::Zero();
    for (const Bin* b : r.bins) moment += luminance(b->light) * b->direction;
    const Bin* best = r.bins.front();
    for (const Bin* b : r.bins)
      if (b->direction.dot(moment) > best->direction.dot(moment)) best = b;
    return best->direction;
  }
  static Vec3d farthest(const Region& r, const std::vector<Vec3d>& places) {
    const Bin* best = nullptr;
    double most = -1;
    for (const Bin* b : r.bins) {
      double nearest = 9;
      for (const Vec3d& p : places) nearest = std::min(nearest, (p - b->direction).norm());
      if (nearest > most) {
        most = nearest;
        best = b;
      }
    }
    return best->direction;
  }
  LightSet of_cells(const std::vector<Vec3d>& places) const {
    std::vector<Rgbd> light(places.size(), Rgbd::Zero());
    std::vector<Vec3d> moment(places.size(), Vec3d::Zero());
    for (const Bin& b : bins_) {
      std::size_t nearest = 0;
      for (std::size_t p = 1; p < places.size(); ++p)
        if ((b.direction - places[p]).norm() < (b.direction - places[nearest]).norm()) nearest = p;
      light[nearest] += b.light;
      moment[nearest] += luminance(b.light) * b.direction;
    }
    LightSet set;
    for (std::size_t p = 0; p < places.size(); ++p)
      set.lights.push_back({moment[p].normalized().cast<float>(), light[p].cast<float>(), -1, 0});
    return set;
  }

  PolarGrid grid_;
  std::vector<Bin> bins_;
};

// A sky with three broad lamps, so that no region has fewer bins than lights, and texture, so that few places are
// equally far.
PolarMap broad_lamps(int variant) {
  PolarMap map = PolarMap::make({18, 60, kPi / 2}, 3);
  std::mt19937 random(static_cast<unsigned>(variant));
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Vec3d> lamps;
  for (int k = 0; k < 3; ++k)
    lamps.push_back(direction_from_spherical({1.4 * uniform(random), 2 * kPi * uniform(random)}));
  for (int ring = 0; ring < 18; ++ring)
    for (int sector = 0; sector < 60; ++sector) {
      const Vec3d d = map.grid.bin_direction(ring, sector);
      double value = 1;
      for (const Vec3d& lamp : lamps) value += 8 * std::exp(-(d - lamp).squaredNorm() / 0.06);
      test::set_bin(map, ring, sector,
                    Rgb::Constant(static_cast<float>(value * (0.8 + 0.4 * uniform(random)))));
    }
  return map;
}

TEST(StructuredSampling, IsAsGoodAsBruteForce) {
  double irradiance = 0;
  double shadow = 0;
  constexpr int kMaps = 8;
  for (int i = 0; i < kMaps; ++i) {
    const PolarMap map = broad_lamps(i);
    const LightEvaluator evaluator(map);
    LightSet ours;
    ours.lights = structured_sampling(map, 32);
    const LightError a = evaluator.error(ours);
    const LightError b = evaluator.error(BruteForce(map).lights(32));
    irradiance += std::log(a.irradiance_rel_rmse / b.irradiance_rel_rmse) / kMaps;
    shadow += std::log(a.shadow_rel_rmse / b.shadow_rel_rmse) / kMaps;
  }
  // The same rules: only equally far places may be taken in another order.
  EXPECT_NEAR(std::exp(irradiance), 1, 0.05);
  EXPECT_NEAR(std::exp(shadow), 1, 0.05);
}

TEST(MapRegions, AreConnectedAcrossTheSeamAndThePole) {
  PolarMap map = test::constant_map({20, 40, kPi / 2}, Rgb::Constant(1));
  for (const int sector : {38, 39, 0, 1})
    test::set_bin(map, 10, sector, Rgb::Constant(1000));                                // across azimuth 0
  for (const int sector : {3, 23}) test::set_bin(map, 0, sector, Rgb::Constant(1000));  // across the zenith
  test::set_bin(map, 15, 20, Rgb::Constant(1000));
  const auto regions = regions_by_luminance(map, 6);
  ASSERT_EQ(regions.size(), 4u);
  std::vector<std::size_t> sizes;
  for (const MapRegion& r : regions) sizes.push_back(r.bins.size());
  EXPECT_EQ(regions[3].layer, 0);
  std::sort(sizes.begin(), sizes.end());
  EXPECT_EQ(sizes, (std::vector<std::size_t>{1, 2, 4, 800 - 7}));
}

TEST(MapRegions, HoldEveryLitBinOnce) {
  for (const auto& [name, map] : test::hard_maps()) {
    std::vector<int> seen(map.grid.size(), 0);
    double power = 0;
    for (const MapRegion& r : regions_by_luminance(map, 6)) {
      power += r.luminance;
      for (const std::uint32_t bin : r.bins) ++seen[bin];
    }
    for (std::size_t bin = 0; bin < seen.size(); ++bin)
      EXPECT_EQ(seen[bin], map.rgb(bin).maxCoeff() > 0 ? 1 : 0) << name;
    EXPECT_NEAR(power / luminance(total_illuminance(map)), 1, 1e-6) << name;  // float solid angles
  }
}

TEST(StructuredSampling, LightsGoToPowerTimesTheFourthRootOfSolidAngle) {
  // A lamp of a 16th of the sky's solid angle and twice its power: L · Ω^¼ is 1 : 1 against the rest's, so each gets
  // half of the lights.
  PolarMap map = PolarMap::make({64, 128, kPi / 2}, 3);
  double lamp = 0, sky = 0;
  const auto in_lamp = [](int ring, int sector) { return ring >= 21 && ring < 37 && sector < 16; };
  for (int ring = 0; ring < 64; ++ring)
    for (int sector = 0; sector < 128; ++sector)
      (in_lamp(ring, sector) ? lamp : sky) += map.grid.bin_solid_angle_sr(ring);
  const double power_ratio = std::pow(sky / lamp, 0.25);  // makes them equal
  const auto lamp_radiance = static_cast<float>(power_ratio * sky / lamp);
  for (int ring = 0; ring < 64; ++ring)
    for (int sector = 0; sector < 128; ++sector)
      test::set_bin(map, ring, sector, Rgb::Constant(in_lamp(ring, sector) ? lamp_radiance : 1.0f));
  const auto lights = structured_sampling(map, 40);
  int in = 0;
  for (const auto& light : lights) {
    const Spherical s = spherical_from_direction(light.direction.cast<double>());
    in += in_lamp(static_cast<int>(s.theta_rad / (kPi / 2) * 64),
                  static_cast<int>(s.lambda_rad / (2 * kPi) * 128))
              ? 1
              : 0;
  }
  // Lights of the sky beside the lamp take some of its border into their cells, and are drawn into it.
  EXPECT_NEAR(in, 20, 2);
}

}  // namespace
}  // namespace lightwell
