// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Where the method of Havran et al. 2005 breaks as printed, and what ours does there. The seam at azimuth 0 is in
// azimuth_seam_test.cpp, single bright bins are in ring_sampling_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lighting/decomposition/clustering.h"
#include "lighting/decomposition/decompose.h"
#include "lighting/evaluation/evaluate.h"
#include "lighting/sampling/azimuth_seam.h"
#include "lighting/sampling/halton.h"
#include "lighting/sampling/ring_distribution.h"
#include "lighting/sampling/ring_sampling.h"
#include "lighting/temporal/light_filter.h"
#include "tests/support/decomposition_maps.h"

namespace lightwell {
namespace {

// The paper's taps (section 3.3), newest first, and the same brought to a sum of 1.
const std::vector<double> kPrintedTaps = {0.06216, 0.01296,  -0.13816, 0.28315, 0.65223,
                                          0.28315, -0.13816, 0.01296,  0.06216};

std::vector<double> normalised(std::vector<double> taps) {
  double sum = 0;
  for (const double tap : taps) sum += tap;
  for (double& tap : taps) tap /= sum;
  return taps;
}

double printed_filter(const std::vector<double>& taps, const std::vector<double>& past, std::size_t now) {
  double out = 0;
  for (std::size_t k = 0; k < taps.size(); ++k) out += taps[k] * past[now >= k ? now - k : 0];
  return out;
}

// What came out of our filter for one light of this power, frame by frame.
std::vector<double> our_filter(const std::vector<double>& power) {
  LightFilter filter(normalised(kPrintedTaps), 1, kPi / 2);
  LightArrays in(1), out(1);
  std::vector<double> result;
  for (const double p : power) {
    in.r[0] = in.g[0] = in.b[0] = static_cast<float>(p);
    filter.apply(in, out);
    result.push_back(static_cast<double>(out.r[0]));
  }
  return result;
}

LightError error_of(const PolarMap& map, int count, Interpolation interpolation) {
  DecomposeOptions options;
  options.interpolation = interpolation;
  options.points = Points::halton;
  return LightEvaluator(map).error(decompose(map, Method::havran, count, options).value());
}

TEST(PrintedHavran, InterpolatedDistributionsLeaveAnErrorThatNoCountOfLightsRemoves) {
  const PolarMap map = test::sun_and_sky({90, 360, kPi / 2}, 200.5, 40.5, 0.8);
  const LightError printed = error_of(map, 16384, Interpolation::printed);
  const LightError ours = error_of(map, 16384, Interpolation::power);
  EXPECT_GT(printed.irradiance_rel_rmse, 0.02);
  EXPECT_LT(ours.irradiance_rel_rmse, 0.004);
  // And what is left of ours still falls with the count.
  EXPECT_LT(error_of(map, 16384, Interpolation::power).shadow_rel_rmse,
            error_of(map, 1024, Interpolation::power).shadow_rel_rmse);
}

TEST(PrintedHavran, AQuarterOfTheLightsLandsInBlackBinsBesideASingleBrightOne) {
  const PolarGrid grid{90, 360, kPi / 2};
  const PolarMap map = test::one_bin(grid, 40, 100, 1000);
  const auto outside = [&](Interpolation interpolation) {
    DecomposeOptions options;
    options.interpolation = interpolation;
    const LightSet set = decompose(map, Method::havran, 1000, options).value();
    int n = 0;
    for (const auto& light : set.lights) {
      const Spherical s = spherical_from_direction(light.direction.cast<double>());
      const double ring = s.theta_rad / (kPi / 2) * 90;
      const double sector = s.lambda_rad / (2 * kPi) * 360;
      // A thousandth of a bin for float directions.
      n += std::abs(ring - 40.5) < 0.501 && std::abs(sector - 100.5) < 0.501 ? 0 : 1;
    }
    return n / 1000.0;
  };
  EXPECT_NEAR(outside(Interpolation::printed), 0.25, 0.02);
  EXPECT_EQ(outside(Interpolation::power), 0);
}

// Independent and slow: the concentric map from angles and radii, cumulative powers in plain arrays, searched from the
// front, azimuth counted from the seam. Interpolated between rings by power, or as printed.
Vec3d brute_force(const PolarMap& map, double seam_turns, const Vec2d& u, bool printed) {
  const int rings = map.grid.rings;
  const int sectors = map.grid.sectors;
  const auto power = [&](int ring, int sector) {
    const auto bin = static_cast<std::size_t>(ring * sectors + (sector % sectors + sectors) % sectors);
    return luminance(map.rgb(bin).cast<double>().eval()) * static_cast<double>(map.solid_angle_sr[bin]);
  };
  std::vector<double> ring_power(static_cast<std::size_t>(rings), 0);
  double total = 0;
  for (int r = 0; r < rings; ++r) {
    for (int s = 0; s < sectors; ++s) ring_power[static_cast<std::size_t>(r)] += power(r, s);
    total += ring_power[static_cast<std::size_t>(r)];
  }
  // Shirley and Chiu: the square's concentric squares become circles, eighth by eighth.
  const double x = 2 * u.x() - 1;
  const double y = 2 * u.y() - 1;
  const double radius = std::max(std::abs(x), std::abs(y));
  double turns =
      std::abs(x) > std::abs(y) ? (x > 0 ? y / x : 4 + y / x) / 8 : (y > 0 ? 2 - x / y : 6 - x / y) / 8;
  turns -= std::floor(turns);
  double rest = radius * radius * total;
  int ring = 0;
  while (ring + 1 < rings && rest >= ring_power[static_cast<std::size_t>(ring)])
    rest -= ring_power[static_cast<std::size_t>(ring++)];
  const double fraction = rest / ring_power[static_cast<std::size_t>(ring)];
  const int other = std::clamp(ring + (fraction < 0.5 ? -1 : 1), 0, rings - 1);
  const double weight = other == ring ? 0 : std::abs(fraction - 0.5);
  const auto share = [&](int s) {
    const double own = (1 - weight) * power(ring, s);
    const double neighbour = weight * power(other, s);
    if (!printed) return own + neighbour;
    return own / ring_power[static_cast<std::size_t>(ring)] +
           neighbour / ring_power[static_cast<std::size_t>(other)];
  };
  double all = 0;
  for (int s = 0; s < sectors; ++s) all += share(s);
  const double seam = seam_turns * sectors;
  const int first = static_cast<int>(seam);
  const double cut = seam - first;
  rest = turns * all;
  double position = seam;
  for (int i = 0; i <= sectors; ++i) {
    const double from = i == 0 ? cut : 0;
    const double to = i == sectors ? cut : 1;
    const double part = share(first + i) * (to - from);
    position = first + i + (part > 0 ? from + (to - from) * std::min(1.0, rest / part) : to);
    if (rest < part) break;
    rest -= part;
  }
  const double inner = std::cos(map.grid.ring_edge_rad(ring));
  const double outer = std::cos(map.grid.ring_edge_rad(ring + 1));
  const double height = inner + (outer - inner) * fraction;
  const double lambda = 2 * kPi * position / sectors;
  const double h = std::sqrt(std::max(0.0, 1 - height * height));
  return {h * std::sin(lambda), height, h * std::cos(lambda)};
}

TEST(HavranTransform, AgreesWithBruteForceRepairedAndAsPrinted) {
  // No black rings, which the printed method leaves open.
  for (unsigned seed = 1; seed <= 3; ++seed) {
    PolarMap map = test::random_map({18, 40, kPi / 2}, seed);
    for (float& value : map.radiance) value += 0.1f;
    RingDistribution distribution(map.grid);
    AzimuthSeam seam(map.grid);
    distribution.build(map);
    seam.follow(distribution);
    for (const bool printed : {false, true}) {
      const HavranTransform sampler(
          distribution, seam,
          printed ? HavranTransform::Interpolation::printed : HavranTransform::Interpolation::by_power);
      for (const Vec2d& u : halton_points(400, seed))
        // Powers in float: a place is known to 1e-7 of the ring's power, a thousandth of a dim bin.
        EXPECT_LT((sampler.sample(u) - brute_force(map, seam.turns(), u, printed)).norm(), 2e-3)
            << u.transpose() << " " << printed;
    }
  }
}

TEST(PrintedHavran, TheFiltersTapsBrightenEverythingByNinePerCent) {
  double sum = 0;
  for (const double tap : kPrintedTaps) sum += tap;
  EXPECT_NEAR(sum, 1.09245, 1e-5);
  for (const double out : our_filter(std::vector<double>(30, 5.0)))
    EXPECT_NEAR(out, 5, 1e-5);  // float rounding
}

TEST(PrintedHavran, AStepOfPowerUndershootsByAlmostSixPerCent) {
  std::vector<double> power(30, 0.0);
  std::fill(power.begin() + 12, power.end(), 1.0);
  const auto taps = normalised(kPrintedTaps);
  double least = 1;
  for (std::size_t now = 0; now < power.size(); ++now)
    least = std::min(least, printed_filter(taps, power, now));
  EXPECT_NEAR(least, -0.058, 0.0005);
  for (const double out : our_filter(power)) {  // between before and after; float rounding
    EXPECT_GE(out, 0);
    EXPECT_LE(out, 1 + 1e-6);
  }
}

TEST(PrintedHavran, ASpikeOfAHundredLeavesNegativePower) {
  std::vector<double> power(30, 1.0);
  power[12] = 100;
  const auto taps = normalised(kPrintedTaps);
  double least = 1;
  for (std::size_t now = 0; now < power.size(); ++now)
    least = std::min(least, printed_filter(taps, power, now));
  EXPECT_NEAR(least, -11.5, 0.1);
  for (const double out : our_filter(power)) {
    EXPECT_GE(out, 1 - 1e-5);  // float rounding
    EXPECT_LE(out, 100 + 1e-3);
  }
}

TEST(PrintedHavran, FilteredDirectionsDipBelowTheHorizon) {
  // A light that sinks to the horizon and stays there.
  const auto taps = normalised(kPrintedTaps);
  std::vector<double> height(30, 0.0);
  std::fill(height.begin(), height.begin() + 12, 0.5);
  LightFilter filter(taps, 1, kPi / 2);
  LightArrays in(1), out(1);
  double least = 1;
  for (std::size_t now = 0; now < height.size(); ++now) {
    least = std::min(least, printed_filter(taps, height, now));
    in.x[0] = static_cast<float>(std::sqrt(1 - height[now] * height[now]));
    in.y[0] = static_cast<float>(height[now]);
    filter.apply(in, out);
    EXPECT_GE(out.y[0], 0);
    EXPECT_NEAR(std::hypot(out.x[0], out.y[0], out.z[0]), 1, 1e-6);  // float rounding
  }
  EXPECT_LT(least, -0.02);
}

TEST(PrintedHavran, OppositeDirectionsSumToNoDirection) {
  // With two equal taps exactly: the printed method then divides by zero.
  EXPECT_EQ(printed_filter({0.5, 0.5}, {1, -1}, 1), 0);
  LightFilter filter(std::vector<double>{0.5, 0.5}, 1, kPi);
  LightArrays in(1), out(1);
  for (const float place : {1.0f, -1.0f, 1.0f, -1.0f}) {
    in.x[0] = place;
    in.y[0] = 0;
    filter.apply(in, out);
    EXPECT_NEAR(std::hypot(out.x[0], out.y[0], out.z[0]), 1, 1e-6);
  }
}

double printed_radius(int clusters) {
  return 1.85 * std::asin(std::sqrt(2.0 / clusters));
}

TEST(PrintedHavran, OneClusterIsOutOfItsDomainAndTwoCoverAlmostTheSphere) {
  EXPECT_TRUE(std::isnan(printed_radius(1)));
  EXPECT_NEAR(printed_radius(2) * 180 / kPi, 166.5, 0.1);
  // Two lights at opposite sides of the horizon: with ε = 166° a light 160° off would be taken as one with the
  // first; ours gives each a cluster of its own where there are two to be had.
  LightArrays lights(2);
  for (std::size_t i = 0; i < 2; ++i) lights.r[i] = lights.g[i] = lights.b[i] = 1;
  lights.x = {1, std::cos(2.79f)};
  lights.y = {0, 0};
  lights.z = {0, std::sin(2.79f)};
  const double apart = std::acos(static_cast<double>(lights.x[1]));
  EXPECT_LT(apart, printed_radius(2));
  Clustering one(1, kPi / 2);
  EXPECT_EQ(one.apply(lights).size(), 1u);
  EXPECT_NEAR(one.apply(lights)[0].illuminance[0], 2, 1e-6);
}

}  // namespace
}  // namespace lightwell
