// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/sampling/ring_sampling.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lighting/sampling/halton.h"
#include "tests/support/sampling_maps.h"

namespace lightwell {
namespace {

// One invariant suite for every sampler: sample, pdf and invert belong together, on every hard map.
struct Standard {
  static StandardInversion make(const RingDistribution& map, const AzimuthSeam& seam) { return {map, seam}; }
};
struct Havran {
  static HavranTransform make(const RingDistribution& map, const AzimuthSeam& seam) { return {map, seam}; }
};
struct Printed {
  static HavranTransform make(const RingDistribution& map, const AzimuthSeam& seam) {
    return {map, seam, HavranTransform::Interpolation::printed};
  }
};

template <class T>
struct Sampling : testing::Test {};
using Samplers = testing::Types<Standard, Havran, Printed>;
TYPED_TEST_SUITE(Sampling, Samplers);

struct Prepared {
  explicit Prepared(const PolarMap& map) : distribution(map.grid), seam(map.grid) {
    distribution.build(map);
    seam.follow(distribution);
  }
  RingDistribution distribution;
  AzimuthSeam seam;
};

std::size_t bin_of(const PolarGrid& grid, const Vec3d& direction) {
  const Spherical s = spherical_from_direction(direction);
  const int ring = std::min(grid.rings - 1, static_cast<int>(s.theta_rad / grid.theta_max_rad * grid.rings));
  const int sector = std::min(grid.sectors - 1, static_cast<int>(s.lambda_rad / (2 * kPi) * grid.sectors));
  return static_cast<std::size_t>(ring) * static_cast<std::size_t>(grid.sectors) +
         static_cast<std::size_t>(sector);
}

// Integral of the pdf over every bin: exact along a sector, where it is constant; `steps` midpoints across a
// ring.
template <class Sampler>
std::vector<double> bin_probabilities(const Sampler& sampler, const PolarGrid& grid, int steps) {
  std::vector<double> p(grid.size(), 0.0);
  for (int k = 0; k < grid.rings; ++k) {
    const double inner = std::cos(grid.ring_edge_rad(k));
    const double outer = std::cos(grid.ring_edge_rad(k + 1));
    for (int s = 0; s < grid.sectors; ++s)
      for (int i = 0; i < steps; ++i) {
        const double theta = std::acos(inner + (outer - inner) * (i + 0.5) / steps);
        const Vec3d d = direction_from_spherical({theta, 2 * kPi * (s + 0.5) / grid.sectors});
        p[static_cast<std::size_t>(k * grid.sectors + s)] +=
            sampler.pdf(d) * grid.bin_solid_angle_sr(k) / steps;
      }
  }
  return p;
}

TYPED_TEST(Sampling, PdfIntegratesToOne) {
  for (const auto& [name, map] : test::hard_maps()) {
    const Prepared p(map);
    double sum = 0;
    for (const double bin : bin_probabilities(TypeParam::make(p.distribution, p.seam), map.grid, 7))
      sum += bin;
    // Exact along the ring for any blend, so only rounding is left, and solid angles kept as float (6e-8).
    EXPECT_NEAR(sum, 1, 1e-6) << name;
  }
}

TYPED_TEST(Sampling, SampleThenInvertReturnsTheSquarePoint) {
  for (const auto& [name, map] : test::hard_maps()) {
    const Prepared p(map);
    const auto sampler = TypeParam::make(p.distribution, p.seam);
    for (const Vec2d& u : halton_points(500, 3)) {
      const Vec3d d = sampler.sample(u);
      Vec2d error = sampler.invert(d) - u;
      error -= error.array().round().matrix();  // azimuth closes on itself
      // Angles carry 1e-16 · conditioning: 1e-8 where a ring's power is 1e-8 of its neighbour's.
      EXPECT_LT(error.norm(), 1e-7) << name << " " << u.transpose();
    }
  }
}

TYPED_TEST(Sampling, DirectionsAreUnitInsideTheMapAndHavePositiveDensity) {
  for (const auto& [name, map] : test::hard_maps()) {
    const Prepared p(map);
    const auto sampler = TypeParam::make(p.distribution, p.seam);
    for (const Vec2d& u : halton_points(300)) {
      const Vec3d d = sampler.sample(u);
      EXPECT_NEAR(d.norm(), 1, 1e-14) << name;
      EXPECT_LE(spherical_from_direction(d).theta_rad, map.grid.theta_max_rad + 1e-12) << name;
      EXPECT_GT(sampler.pdf(d), 0) << name;
    }
    for (const Vec2d& u :
         {Vec2d(0, 0), Vec2d(1, 1), Vec2d(0, 1), Vec2d(1, 0), Vec2d(.5, .5), Vec2d(1 - 1e-16, .3)})
      EXPECT_TRUE(sampler.sample(u).allFinite()) << name << " " << u.transpose();
  }
}

TYPED_TEST(Sampling, CountsPerBinFollowThePdf) {
  constexpr std::size_t kCount = 40000;
  for (const auto& [name, map] : test::hard_maps()) {
    const Prepared p(map);
    const auto sampler = TypeParam::make(p.distribution, p.seam);
    std::vector<double> counts(map.grid.size(), 0);
    for (const Vec2d& u : halton_points(kCount)) ++counts[bin_of(map.grid, sampler.sample(u))];
    const auto expected = bin_probabilities(sampler, map.grid, 256);
    double chi2 = 0, cells = 0;
    for (std::size_t b = 0; b < counts.size(); ++b) {
      const double mean = expected[b] * kCount;
      EXPECT_NEAR(counts[b], mean, 5 * std::sqrt(mean) + 3) << name << " bin " << b;
      if (mean < 5) continue;
      chi2 += (counts[b] - mean) * (counts[b] - mean) / mean;
      ++cells;
    }
    // Random points would give cells ± √(2 cells); a low-discrepancy sequence gives less.
    EXPECT_LT(chi2, cells + 5 * std::sqrt(2 * cells) + 1) << name;
  }
}

TYPED_TEST(Sampling, BlackMapIsSampledEvenlyOverTheCap) {
  const PolarGrid grid{18, 40, kPi / 2};
  const PolarMap map = PolarMap::make(grid, 3);
  const Prepared p(map);
  const auto sampler = TypeParam::make(p.distribution, p.seam);
  Vec3d mean = Vec3d::Zero();
  for (const Vec2d& u : halton_points(4096)) {
    const Vec3d d = sampler.sample(u);
    EXPECT_NEAR(sampler.pdf(d), 1 / (2 * kPi), 1e-12);
    mean += d / 4096;
  }
  EXPECT_LT((mean - Vec3d(0, 0.5, 0)).norm(),
            0.005);  // centroid of a hemisphere's shell; discrepancy of 4096 points
  LightArrays lights(64);
  const auto points = warp_points<decltype(sampler)>(halton_points(64));
  sample_lights(sampler, map, points, lights);
  for (std::size_t i = 0; i < 64; ++i) {
    EXPECT_EQ(lights.r[i] + lights.g[i] + lights.b[i], 0);
    EXPECT_NEAR(std::hypot(lights.x[i], lights.y[i], lights.z[i]), 1, 1e-6);
    EXPECT_GE(lights.y[i], 0);
  }
}

TYPED_TEST(Sampling, ManyLightsAtOnceAreTheSamplesOneByOne) {
  for (const auto& [name, map] : test::hard_maps()) {
    const Prepared p(map);
    const auto sampler = TypeParam::make(p.distribution, p.seam);
    const auto square = halton_points(203);
    LightArrays lights(203);
    sample_lights(sampler, map, warp_points<decltype(sampler)>(square), lights);
    for (std::size_t i = 0; i < square.size(); ++i) {
      const Vec3d d = sampler.sample(square[i]);
      const Vec3d f(lights.x[i], lights.y[i], lights.z[i]);
      EXPECT_LT((d - f).norm(), 1e-6) << name;  // float, azimuth in turns: 2π · 6e-8
    }
  }
}

TYPED_TEST(Sampling, TotalPowerIsExactPerChannel) {
  for (const auto& [name, map] : test::hard_maps())
    for (const std::size_t count : {1u, 2u, 17u, 300u}) {
      const Prepared p(map);
      const auto sampler = TypeParam::make(p.distribution, p.seam);
      LightArrays lights(count);
      sample_lights(sampler, map, warp_points<decltype(sampler)>(halton_points(count)), lights);
      Rgbd sum = Rgbd::Zero();
      for (std::size_t i = 0; i < count; ++i) {
        sum += Rgb(lights.r[i], lights.g[i], lights.b[i]).cast<double>();
        EXPECT_TRUE(lights.r[i] >= 0 && lights.g[i] >= 0 && lights.b[i] >= 0);
      }
      const Rgbd total = total_illuminance(map);
      // Float lights and float partial sums: a few parts in 10⁷.
      EXPECT_LT(((sum - total).abs() / total).maxCoeff(), 2e-6) << name << " " << count;
    }
}

TEST(SampleLights, AChannelThatNoLightMeetsIsSpreadNotLost) {
  // One bright red bin, one blue bin too faint to be chosen.
  const PolarGrid grid{18, 40, kPi / 2};
  PolarMap map = PolarMap::make(grid, 3);
  test::set_bin(map, 4, 10, Rgb(1000, 0, 0));
  test::set_bin(map, 12, 30, Rgb(0, 0, 1));
  const Prepared p(map);
  const HavranTransform sampler(p.distribution, p.seam);
  LightArrays lights(8);
  sample_lights(sampler, map, warp_points<HavranTransform>(halton_points(8)), lights);
  double blue = 0;
  for (const float b : lights.b) blue += static_cast<double>(b);
  EXPECT_NEAR(blue, total_illuminance(map)[2], 1e-9);  // float rounding of 1e-2
}

// Independent and slow: cumulative sums of everything in a plain double array, searched from the front.
Vec3d brute_force_standard(const PolarMap& map, double seam_turns, const Vec2d& u) {
  const auto rings = static_cast<std::size_t>(map.grid.rings);
  const auto sectors = static_cast<std::size_t>(map.grid.sectors);
  const auto power = [&](std::size_t k, std::size_t s) {
    const std::size_t bin = k * sectors + s;
    return luminance(Rgbd(map.rgb(bin).cast<double>())) * static_cast<double>(map.solid_angle_sr[bin]);
  };
  std::vector<double> ring_power(rings, 0);
  double total = 0;
  for (std::size_t k = 0; k < rings; ++k) {
    for (std::size_t s = 0; s < sectors; ++s) ring_power[k] += power(k, s);
    total += ring_power[k];
  }
  double rest = u.x() * total;
  std::size_t ring = 0;
  while (ring + 1 < rings && rest >= ring_power[ring]) rest -= ring_power[ring++];
  const double c0 = std::cos(map.grid.ring_edge_rad(static_cast<int>(ring)));
  const double c1 = std::cos(map.grid.ring_edge_rad(static_cast<int>(ring) + 1));
  const double height = c0 + (c1 - c0) * rest / ring_power[ring];
  // From the seam on, around once; the seam's own sector comes twice, in parts.
  const auto first = static_cast<std::size_t>(seam_turns * static_cast<double>(sectors));
  const double cut = seam_turns * static_cast<double>(sectors) - static_cast<double>(first);
  rest = u.y() * ring_power[ring];
  double position = 0;
  for (std::size_t i = 0; i <= sectors; ++i) {
    const std::size_t s = (first + i) % sectors;
    const double from = i == 0 ? cut : 0;
    const double to = i == sectors ? cut : 1;
    const double part = power(ring, s) * (to - from);
    position =
        static_cast<double>(first + i) + (part > 0 ? from + (to - from) * std::min(1.0, rest / part) : to);
    if (rest < part) break;
    rest -= part;
  }
  const double lambda = 2 * kPi * position / static_cast<double>(sectors);
  const double h = std::sqrt(std::max(0.0, 1 - height * height));
  return {h * std::sin(lambda), height, h * std::cos(lambda)};
}

TEST(StandardInversion, AgreesWithBruteForce) {
  for (const auto& [name, map] : test::hard_maps()) {
    const Prepared p(map);
    const StandardInversion sampler(p.distribution, p.seam);
    for (const Vec2d& u : halton_points(300, 8)) {
      const Vec3d expected = brute_force_standard(map, p.seam.turns(), u);
      // Power in float: a bin's border lies within 1e-7 of the ring's power, 3e-6 of a sector at the dimmest
      // bins here (1e-4 of the ring); beside the sun of 1e8 a border is uncertain by sectors, so the density
      // decides there.
      if (name == "sun of 1e8") continue;
      EXPECT_LT((sampler.sample(u) - expected).norm(), 2e-3) << name << " " << u.transpose();
    }
  }
}

TEST(StandardInversion, PdfIsTheMapsOwnPower) {
  for (const auto& [name, map] : test::hard_maps()) {
    const Prepared p(map);
    const StandardInversion sampler(p.distribution, p.seam);
    const auto probability = bin_probabilities(sampler, map.grid, 1);
    const double total = luminance(total_illuminance(map));
    for (std::size_t b = 0; b < probability.size(); ++b) {
      const double share =
          luminance(Rgbd(map.rgb(b).cast<double>())) * static_cast<double>(map.solid_angle_sr[b]) / total;
      EXPECT_NEAR(probability[b], share, 1e-6 * share + 1e-15) << name;  // float power
    }
  }
}

TEST(HavranTransform, RingsKeepTheirPowerExactly) {
  for (const auto& [name, map] : test::hard_maps()) {
    const Prepared p(map);
    const auto probability = bin_probabilities(HavranTransform(p.distribution, p.seam), map.grid, 3);
    for (int k = 0; k < map.grid.rings; ++k) {
      double ring = 0;
      for (int s = 0; s < map.grid.sectors; ++s)
        ring += probability[static_cast<std::size_t>(k * map.grid.sectors + s)];
      EXPECT_NEAR(ring, p.distribution.ring_power(k) / p.distribution.total_power(), 1e-6)
          << name;  // float solid angles
    }
  }
}

// The share of the lights that lands in the bin, over many points.
template <class Sampler>
double share_in_bin(const Sampler& sampler, const PolarGrid& grid, std::size_t bin) {
  int hits = 0;
  for (const Vec2d& u : halton_points(2000)) hits += bin_of(grid, sampler.sample(u)) == bin ? 1 : 0;
  return hits / 2000.0;
}

TEST(HavranTransform, AllOfASingleBrightBinLandsInItWhereThePrintedMethodGivesThreeQuarters) {
  const PolarGrid grid{18, 40, kPi / 2};
  for (const int ring : {0, 9, 17})
    for (const int sector : {0, 20, 39}) {
      PolarMap map = PolarMap::make(grid, 3);
      test::set_bin(map, ring, sector, Rgb(5, 4, 3));
      const Prepared p(map);
      const auto bin = static_cast<std::size_t>(ring * grid.sectors + sector);
      EXPECT_EQ(share_in_bin(HavranTransform(p.distribution, p.seam), grid, bin), 1);
      EXPECT_EQ(share_in_bin(StandardInversion(p.distribution, p.seam), grid, bin), 1);
      const HavranTransform printed(p.distribution, p.seam, HavranTransform::Interpolation::printed);
      // The neighbour's share is ∫|f − ½| = ¼; half of that where the ring has one neighbour only; the bin's
      // own sector gets 1/40 of the even part back. Discrepancy of 2000 points: .01.
      const double dark = ring == 9 ? 0.25 : 0.125;
      EXPECT_NEAR(share_in_bin(printed, grid, bin), 1 - dark * (1 - 1.0 / 40), 0.01);
    }
}

TEST(HavranTransform, SunWithMostOfTheEnergyKeepsIt) {
  const PolarGrid grid{90, 360, kPi / 2};
  const PolarMap map = test::sun_and_sky(grid, 200.5, 40.5, 0.97);
  const Prepared p(map);
  const std::size_t bin = 40 * 360 + 200;
  EXPECT_NEAR(share_in_bin(HavranTransform(p.distribution, p.seam), grid, bin), 0.97, 0.005);
  const HavranTransform printed(p.distribution, p.seam, HavranTransform::Interpolation::printed);
  EXPECT_NEAR(share_in_bin(printed, grid, bin), 0.73, 0.01)
      << "what papers/NOTES.md found of the printed method";
}

TEST(HavranTransform, SmallStepsInTheSquareAreSmallStepsOnASmoothSky) {
  const PolarGrid grid{90, 360, kPi / 2};
  PolarMap map = PolarMap::make(grid, 3);
  for (int k = 0; k < grid.rings; ++k)
    for (int s = 0; s < grid.sectors; ++s) {
      const Vec3d d = grid.bin_direction(k, s);
      test::set_bin(map, k, s, Rgb::Constant(static_cast<float>(1 + 0.9 * d.x() * d.y() + 0.3 * d.z())));
    }
  const Prepared p(map);
  const HavranTransform havran(p.distribution, p.seam);
  const StandardInversion standard(p.distribution, p.seam);
  double largest = 0, largest_standard = 0;
  for (const Vec2d& u : halton_points(20000)) {
    const Vec2d v = (u + Vec2d(1e-4, 0.6e-4)).cwiseMin(1);
    largest = std::max(largest, (havran.sample(u) - havran.sample(v)).norm());
    largest_standard = std::max(largest_standard, (standard.sample(u) - standard.sample(v)).norm());
  }
  // Density varies by less than 10 around its mean and the concentric map stretches by less than 3: 2π·10·…
  // of 1.2e-4.
  EXPECT_LT(largest, 0.01);
  EXPECT_LT(largest, largest_standard) << "rings that do not share their distribution jump at their border";
}

TEST(RingDistribution, KeepsWhatIsDimBesideASunOf1e8) {
  const PolarGrid grid{4, 64, kPi / 2};
  PolarMap map = test::constant_map(grid, Rgb::Constant(1));
  test::set_bin(map, 2, 1, Rgb::Constant(1e8f));
  RingDistribution d(grid);
  d.build(map);
  // The last dim sector of the sun's ring, measured as a difference of cumulative sums.
  const double share = d.power_before(2, 1) - d.power_before(2, 63.0 / 64);
  EXPECT_NEAR(share / grid.bin_solid_angle_sr(2), 1, 1e-5);  // double: 1e8 · 1e-16 / 1, and float power
}

TEST(RingDistribution, TotalIsTheMapsPerChannel) {
  for (const auto& [name, map] : test::hard_maps()) {
    RingDistribution d(map.grid);
    d.build(map);
    const Rgbd total = total_illuminance(map);
    EXPECT_LT(((d.total_illuminance() - total).abs() / total).maxCoeff(), 1e-6)
        << name;  // float partial sums
    EXPECT_NEAR(d.total_power() / luminance(total), 1, 1e-6) << name;
  }
}

}  // namespace
}  // namespace lightwell
