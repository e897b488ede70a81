// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/light_kernel/kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "lighting/azimuth_seam.h"
#include "lighting/ring_distribution.h"
#include "lighting/ring_sampling.h"

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

// The search against a plain walk along the ring, bin by bin.
TEST_P(LightKernel, PlacesAreWhereAWalkAlongTheRingEnds) {
  const PolarGrid grid = GetParam();
  RingDistribution distribution(grid);
  distribution.build(wild_map(grid, 1, 11));
  AzimuthSeam seam(grid);
  seam.fix(distribution, 0);
  std::mt19937 random(13);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < 500; ++i) {
    const RingCoordinates point = {uniform(random), uniform(random)};
    MapPlace place;
    light_kernel::kernels().locate(distribution.tables(), seam.tables(), Blending::own, &point, 1, &place);
    double before = 0;
    int ring = 0;
    while (ring + 1 < grid.rings &&
           before + distribution.ring_power(ring) <= point.t * distribution.total_power())
      before += distribution.ring_power(ring++);
    ASSERT_EQ(place.ring.ring, ring);
    const double reached = point.s * distribution.ring_power(ring);
    double sum = 0;
    for (int s = 0; s < place.sector.sector; ++s) sum += distribution.bin_power(ring, s);
    const double bin = distribution.bin_power(ring, place.sector.sector);
    EXPECT_GT(bin, 0);
    // Block sums are made in float: 2e-7 of the ring's power either way.
    const double slack = 2e-7 * distribution.ring_power(ring);
    EXPECT_NEAR(sum + place.sector.fraction * bin, reached, slack);
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

INSTANTIATE_TEST_SUITE_P(Grids, LightKernel,
                         testing::Values(PolarGrid{90, 360, kPi / 2}, PolarGrid{1, 1, kPi / 2},
                                         PolarGrid{17, 8, kPi / 2}, PolarGrid{33, 67, 1.9},
                                         PolarGrid{16, 1000, kPi}),
                         [](const auto& test) {
                           return std::to_string(test.param.rings) + "x" + std::to_string(test.param.sectors);
                         });

}  // namespace
}  // namespace lightwell
