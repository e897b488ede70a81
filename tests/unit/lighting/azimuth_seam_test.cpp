// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/sampling/azimuth_seam.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lighting/sampling/halton.h"
#include "lighting/sampling/ring_sampling.h"
#include "tests/support/sampling_maps.h"

namespace lightwell {
namespace {

const PolarGrid kGrid{90, 360, kPi / 2};

double turns_apart(double a, double b) {
  const double d = a - b;
  return std::abs(d - std::round(d));
}

// Follows maps with a seam and remembers by how much any light moved between frames, degrees.
class Follower {
 public:
  explicit Follower(bool printed = false) : printed_(printed) {}

  double step(const PolarMap& map) {
    distribution_.build(map);
    if (printed_)
      seam_.fix(distribution_, 0);
    else
      seam_.follow(distribution_);
    const HavranTransform sampler(
        distribution_, seam_,
        printed_ ? HavranTransform::Interpolation::printed : HavranTransform::Interpolation::by_power);
    double largest = 0;
    std::vector<Vec3d> now;
    for (const Vec2d& u : points_) now.push_back(sampler.sample(u));
    for (std::size_t i = 0; i < last_.size(); ++i)
      largest = std::max(largest, std::acos(std::clamp(now[i].dot(last_[i]), -1.0, 1.0)) * 180 / kPi);
    last_ = now;
    return largest;
  }
  [[nodiscard]] double seam() const { return seam_.turns(); }

 private:
  bool printed_;
  RingDistribution distribution_{kGrid};
  AzimuthSeam seam_{kGrid};
  std::vector<Vec2d> points_ = halton_points(300);
  std::vector<Vec3d> last_;
};

TEST(AzimuthSeam, StandsOppositeASingleLight) {
  for (const double azimuth : {0.0, 77.0, 200.0, 359.0}) {
    Follower follower;
    follower.step(test::sun_and_sky(kGrid, azimuth, 50, 0.9));
    EXPECT_LT(turns_apart(follower.seam(), azimuth / 360 + 0.5), 10.0 / 360)
        << azimuth;  // the candidates' 5°, blocks of 8°
  }
}

TEST(AzimuthSeam, StandsBetweenTwoOppositeLights) {
  PolarMap map = test::constant_map(kGrid, Rgb::Constant(0.01f));
  test::set_bin(map, 60, 100, Rgb::Constant(3e4f));
  test::set_bin(map, 60, 280, Rgb::Constant(1e4f));
  Follower follower;
  follower.step(map);
  EXPECT_GT(turns_apart(follower.seam(), 100.5 / 360), 50.0 / 360);
  EXPECT_GT(turns_apart(follower.seam(), 280.5 / 360), 50.0 / 360);
}

TEST(AzimuthSeam, RestsUnderNoiseAndInEvenLight) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> noise(0.95f, 1.05f);
  for (const double sun : {0.0, 0.05, 0.9}) {
    Follower follower;
    const PolarMap clean = test::sun_and_sky(kGrid, 30, 50, sun);
    follower.step(clean);
    const double seam = follower.seam();
    for (int frame = 0; frame < 20; ++frame) {
      PolarMap map = clean;
      for (float& v : map.radiance) v *= noise(random);
      follower.step(map);
      EXPECT_EQ(follower.seam(), seam) << sun;
    }
  }
}

TEST(AzimuthSeam, SunCrossingAzimuthZeroMovesNoLightFarWhereThePrintedMethodJumps) {
  for (const double share : {0.5, 0.9, 0.97}) {
    Follower ours;
    Follower printed(true);
    double largest = 0, largest_printed = 0;
    for (double azimuth = -12; azimuth <= 12; azimuth += 0.5) {
      const PolarMap map = test::sun_and_sky(kGrid, azimuth, 50, share);
      largest = std::max(largest, ours.step(map));
      largest_printed = std::max(largest_printed, printed.step(map));
    }
    EXPECT_LT(largest, 8) << share;
    EXPECT_GT(largest_printed, 60) << share;
  }
}

TEST(AzimuthSeam, SunAllTheWayRoundMovesNoLightFar) {
  for (const double share : {0.3, 0.9, 0.97}) {
    Follower ours;
    double largest = 0;
    for (double azimuth = 0; azimuth <= 400; azimuth += 0.5)
      largest = std::max(largest, ours.step(test::sun_and_sky(kGrid, azimuth, 50, share)));
    EXPECT_LT(largest, 8) << share;
  }
}

TEST(AzimuthSeam, JumpLeavesTheLightsOfMostOfTheEnergyWhereTheyAre) {
  // Two lamps with the seam between them, then a third, twice as strong, is switched on beside the seam.
  PolarMap map = test::constant_map(kGrid, Rgb::Constant(0.001f));
  test::set_bin(map, 60, 100, Rgb::Constant(1e4f));
  test::set_bin(map, 60, 280, Rgb::Constant(1e4f));
  RingDistribution d(kGrid);
  AzimuthSeam seam(kGrid);
  d.build(map);
  seam.follow(d);
  const double before = seam.turns();
  PolarMap lit = map;
  const int beside = static_cast<int>(before * 360);
  test::set_bin(lit, 20, beside, Rgb::Constant(8e3f));
  RingDistribution e(kGrid);
  e.build(lit);
  AzimuthSeam unmoved(kGrid);
  unmoved.fix(e, before);
  seam.follow(e);
  ASSERT_GT(turns_apart(seam.turns(), before), 30.0 / 360) << "the seam had reason to jump";
  // The mapping of the old lamps' ring, before and after the jump, at the same map.
  const double t = (e.ring_start(60) + 0.5 * e.ring_power(60)) / e.total_power();
  int moved = 0;
  for (int i = 0; i < 1000; ++i) {
    const RingCoordinates point = {t, (i + 0.5) / 1000};
    MapPlace now, then;
    StandardInversion(e, seam).locate({&point, 1}, {&now, 1});
    StandardInversion(e, unmoved).locate({&point, 1}, {&then, 1});
    ASSERT_EQ(now.ring.ring, 60);
    moved += now.sector.sector != then.sector.sector ? 1 : 0;
  }
  EXPECT_LT(moved, 20) << "of 1000 lights of the lamps that were there before";
}

TEST(AzimuthSeam, PlaceAndPowerTargetAreInverse) {
  for (const auto& [name, map] : test::hard_maps()) {
    RingDistribution d(map.grid);
    AzimuthSeam seam(map.grid);
    d.build(map);
    seam.follow(d);
    for (int k = 0; k < map.grid.rings; ++k) {
      const RingBlend blend{k, std::min(k + 1, map.grid.rings - 1), 0.7, 0.3, 0};
      if (d.power(blend) <= 0) continue;
      for (const double s : {0.0, 0.1, 0.5, 0.77, 0.999}) {
        const double target = seam.power_target(d, blend, s);
        EXPECT_GE(target, 0);
        EXPECT_LE(target, d.power(blend));
        EXPECT_LT(turns_apart(seam.place(d, blend, target), s), 1e-12) << name;
      }
    }
  }
}

}  // namespace
}  // namespace lightwell
