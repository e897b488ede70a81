// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/sampling/light_kernel/kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "lighting/sampling/azimuth_seam.h"
#include "lighting/sampling/ring_distribution.h"
#include "lighting/sampling/ring_sampling.h"

namespace lightwell {
namespace {

using light_kernel::Blending;
using light_kernel::Kernels;

// Ten decades, black bins among them.
PolarMap wild_map(const PolarGrid& grid, int channels, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> decade(-4, 6), black(0, 1);
  PolarMap map = PolarMap::make(grid, channels);
  for (float& v : map.radiance)
    v = black(random) < 0.3 ? 0.0f : static_cast<float>(std::pow(10, decade(random)));
  map.radiance[0] = 1;  // so that the smallest grids are not black
  return map;
}

class LightKernel : public testing::TestWithParam<PolarGrid> {
 protected:
  void SetUp() override {
    if (!light_kernel::avx2_kernels())
      GTEST_SKIP() << "this machine has no AVX2: there is one set of kernels only";
  }
  const Kernels& wide() const { return *light_kernel::avx2_kernels(); }
  const Kernels& portable() const { return light_kernel::kPortableKernels; }
};

TEST_P(LightKernel, RingSumsAreTheSameBitsOnEveryInstructionSet) {
  const PolarGrid grid = GetParam();
  const auto sectors = static_cast<std::size_t>(grid.sectors);
  const std::size_t blocks = sectors / light_kernel::kBlock + 2;
  for (const int channels : {1, 3}) {
    const PolarMap map = wild_map(grid, channels, 3);
    const std::size_t plane = channels == 1 ? 0 : grid.size();
    for (int ring = 0; ring < grid.rings; ++ring) {
      const float* red = map.radiance.data() + static_cast<std::size_t>(ring) * sectors;
      const light_kernel::RingPlanes planes = {
          red, red + plane, red + 2 * plane,
          map.solid_angle_sr.data() + static_cast<std::size_t>(ring) * sectors};
      struct Out {
        std::vector<float> power;
        std::vector<double> start;
        double total = 0;
        double rgb[3] = {};
      } a{std::vector<float>(sectors), std::vector<double>(blocks), 0, {}}, b = a;
      wide().weigh_ring(planes, channels == 1, grid.sectors, a.power.data(), a.start.data(), &a.total, a.rgb);
      portable().weigh_ring(planes, channels == 1, grid.sectors, b.power.data(), b.start.data(), &b.total,
                            b.rgb);
      EXPECT_EQ(a.power, b.power);
      EXPECT_EQ(a.start, b.start);
      EXPECT_EQ(a.total, b.total);
      for (int c = 0; c < 3; ++c) EXPECT_EQ(a.rgb[c], b.rgb[c]);
    }
  }
}

TEST_P(LightKernel, PlacesAreTheSameBitsOnEveryInstructionSet) {
  const PolarGrid grid = GetParam();
  RingDistribution distribution(grid);
  distribution.build(wild_map(grid, 1, 5));
  ASSERT_GT(distribution.total_power(), 0);
  AzimuthSeam seam(grid);
  seam.follow(distribution);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<RingCoordinates> points(1003);
  for (RingCoordinates& p : points) p = {uniform(random), uniform(random)};
  points[0] = {0, 0};
  points[1] = {1, std::nextafter(1, 0)};
  for (const Blending blending : {Blending::own, Blending::by_power, Blending::printed}) {
    std::vector<MapPlace> a(points.size()), b(points.size());
    const auto count = static_cast<int>(points.size());
    wide().locate(distribution.tables(), seam.tables(), blending, points.data(), count, a.data());
    portable().locate(distribution.tables(), seam.tables(), blending, points.data(), count, b.data());
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_EQ(a[i].ring.ring, b[i].ring.ring);
      EXPECT_EQ(a[i].ring.fraction, b[i].ring.fraction);
      EXPECT_EQ(a[i].sector.sector, b[i].sector.sector);
      EXPECT_EQ(a[i].sector.fraction, b[i].sector.fraction);
      EXPECT_EQ(a[i].neighbour, b[i].neighbour);
    }
  }
}

TEST_P(LightKernel, FiltersAndDirectionsAreTheSameBitsOnEveryInstructionSet) {
  constexpr int kCount = 301, kTaps = 9;
  std::mt19937 random(17);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<std::vector<float>> frames(kTaps, std::vector<float>(kCount));
  std::vector<const float*> past;
  for (auto& f : frames) {
    for (float& v : f) v = uniform(random);
    past.push_back(f.data());
  }
  const std::vector<float> taps = {-0.02f, 0.01f, 0.1f, 0.25f, 0.32f, 0.25f, 0.1f, 0.01f, -0.02f};
  const auto both = [&](auto work) { return std::pair(work(wide()), work(portable())); };
  const auto [a, b] = both([&](const Kernels& k) {
    std::vector<float> out(kCount);
    k.filter(past.data(), taps.data(), kTaps, kCount, out.data());
    return out;
  });
  EXPECT_EQ(a, b);
  const auto [c, d] = both([&](const Kernels& k) {
    std::vector<float> out(kCount);
    k.filter_within_range(past.data(), taps.data(), kTaps, kCount, out.data());
    return out;
  });
  EXPECT_EQ(c, d);
  const auto [e, f] = both([&](const Kernels& k) {
    std::vector<float> x(kCount), y(kCount), z(kCount);
    for (std::size_t i = 0; i < kCount; ++i) {
      x[i] = static_cast<float>(i) / kCount;
      y[i] = static_cast<float>((i * 7) % kCount) / kCount;
    }
    k.directions(x.data(), y.data(), z.data(), kCount);
    std::vector<float> last(3 * kCount, 0.5f);
    k.settle_directions(x.data(), y.data(), z.data(), last.data(), last.data() + kCount,
                        last.data() + 2 * kCount, kCount, 0.1f, std::sqrt(0.99f));
    x.insert(x.end(), y.begin(), y.end());
    x.insert(x.end(), z.begin(), z.end());
    return x;
  });
  EXPECT_EQ(e, f);
}

// On the kernels of every instruction set that runs here.
class EveryLightKernel : public testing::TestWithParam<PolarGrid> {
 protected:
  static std::vector<const Kernels*> all() {
    std::vector<const Kernels*> kernels = {&light_kernel::kPortableKernels};
    if (light_kernel::avx2_kernels()) kernels.push_back(light_kernel::avx2_kernels());
    return kernels;
  }
};

// The search against a plain walk along the ring, bin by bin, for every blending and with the seam anywhere.
TEST_P(EveryLightKernel, PlacesAreWhereAWalkAlongTheRingEnds) {
  const PolarGrid grid = GetParam();
  RingDistribution d(grid);
  d.build(wild_map(grid, 1, 11));
  std::mt19937 random(13);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const Kernels* kernels : all())
    for (const Blending blending : {Blending::own, Blending::by_power, Blending::printed})
      for (int i = 0; i < 200; ++i) {
        AzimuthSeam seam(grid);
        const double cut = uniform(random);
        seam.fix(d, cut);
        const RingCoordinates point = {uniform(random), uniform(random)};
        MapPlace place;
        kernels->locate(d.tables(), seam.tables(), blending, &point, 1, &place);
        // The ring.
        double before = 0;
        int ring = 0;
        while (ring + 1 < grid.rings && before + d.ring_power(ring) <= point.t * d.total_power())
          before += d.ring_power(ring++);
        ASSERT_EQ(place.ring.ring, ring);
        // The bins' powers of its blend, as the header states it.
        const double fraction = (point.t * d.total_power() - before) / d.ring_power(ring);
        const int side = std::clamp(ring + (fraction < 0.5 ? -1 : 1), 0, grid.rings - 1);
        const double weight = blending == Blending::own || side == ring ? 0 : std::abs(fraction - 0.5);
        std::vector<double> power;
        for (int s = 0; s < grid.sectors; ++s) {
          double own = d.bin_power(ring, s), other = d.bin_power(side, s);
          if (blending == Blending::printed) {
            own /= d.ring_power(ring);
            other = d.ring_power(side) > 0 ? other / d.ring_power(side) : 1.0 / grid.sectors;
          }
          power.push_back((1 - weight) * own + weight * other);
        }
        const auto power_before = [&](double sectors) {
          double sum = 0;
          for (int s = 0; s < grid.sectors; ++s)
            sum += power[static_cast<std::size_t>(s)] * std::clamp(sectors - s, 0.0, 1.0);
          return sum;
        };
        const double total = power_before(grid.sectors);
        const double reached = std::fmod(power_before(cut * grid.sectors) + point.s * total, total);
        EXPECT_GT(power[static_cast<std::size_t>(place.sector.sector)], 0);
        // Sums of a thousand doubles.
        EXPECT_NEAR(power_before(place.sector.sector + place.sector.fraction), reached, 1e-12 * total)
            << "blending " << static_cast<int>(blending);
      }
}

TEST_P(EveryLightKernel, ABinBesideASun1e8TimesAsBrightGetsItsShare) {
  const PolarGrid grid = GetParam();
  if (grid.sectors < 3) GTEST_SKIP() << "no room for neighbours";
  PolarMap map = PolarMap::make(grid, 1);
  map.radiance[0] = 1e8f;
  map.radiance[1] = 1;
  map.radiance[2] = 1;
  RingDistribution d(grid);
  d.build(map);
  AzimuthSeam seam(grid);
  seam.fix(d, 0);
  for (const Kernels* kernels : all())
    for (int bin = 1; bin < 3; ++bin) {
      const RingCoordinates point = {0.5, (1e8 + bin - 0.5) / (1e8 + 2)};
      MapPlace place;
      kernels->locate(d.tables(), seam.tables(), Blending::own, &point, 1, &place);
      EXPECT_EQ(place.sector.sector, bin);
      EXPECT_NEAR(place.sector.fraction, 0.5, 1e-6);  // 1e8 in double leaves eight digits of the bin
    }
}

TEST(LightKernelDirections, AreThoseOfTheMathematicsLibrary) {
  constexpr int kCount = 10000;
  std::vector<const Kernels*> all = {&light_kernel::kPortableKernels};
  if (light_kernel::avx2_kernels()) all.push_back(light_kernel::avx2_kernels());
  for (const Kernels* kernels : all) {
    std::vector<float> x(kCount), y(kCount), z(kCount);
    for (int i = 0; i < kCount; ++i) {
      x[static_cast<std::size_t>(i)] = 1;  // the horizon, where sin θ is 1
      y[static_cast<std::size_t>(i)] = static_cast<float>(i) / (kCount - 1);
    }
    const std::vector<float> turns = y;
    kernels->directions(x.data(), y.data(), z.data(), kCount);
    for (std::size_t i = 0; i < kCount; ++i) {
      const double lambda = 2 * kPi * static_cast<double>(turns[i]);
      // Three roundings to float, of numbers up to 2π/8 before and 1 after.
      EXPECT_NEAR(static_cast<double>(x[i]), std::sin(lambda), 1.5e-7);
      EXPECT_NEAR(static_cast<double>(z[i]), std::cos(lambda), 1.5e-7);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Grids, LightKernel,
                         testing::Values(PolarGrid{90, 360, kPi / 2}, PolarGrid{1, 1, kPi / 2},
                                         PolarGrid{17, 8, kPi / 2}, PolarGrid{33, 67, 1.9},
                                         PolarGrid{16, 1000, kPi}),
                         [](const auto& test) {
                           return std::to_string(test.param.rings) + "x" + std::to_string(test.param.sectors);
                         });

INSTANTIATE_TEST_SUITE_P(Grids, EveryLightKernel,
                         testing::Values(PolarGrid{90, 360, kPi / 2}, PolarGrid{1, 1, kPi / 2},
                                         PolarGrid{17, 8, kPi / 2}, PolarGrid{33, 67, 1.9},
                                         PolarGrid{16, 1000, kPi}),
                         [](const auto& test) {
                           return std::to_string(test.param.rings) + "x" + std::to_string(test.param.sectors);
                         });

}  // namespace
}  // namespace lightwell
