// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/lamp_tracks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "tests/support/live_stage.h"

namespace lightwell {
namespace {

constexpr double kDegree = kPi / 180;

const std::vector<Vec3d> kPlaces = {{0, 0, 0}, {2, 0, 0}, {0, 0, 2}, {2, 0.3, 2}, {1, 0.5, 1}};

// What probes would say of balls, each ray turned by a normal error.
class Probes {
 public:
  explicit Probes(std::vector<Vec3d> places = kPlaces) : places_(std::move(places)), lamps_(places_.size()) {}
  std::span<const ProbeSightings> see(const std::vector<test::LampBall>& balls, double error_rad = 0) {
    std::normal_distribution<double> error(0, error_rad);
    seen_.clear();
    for (std::size_t n = 0; n < places_.size(); ++n) {
      lamps_[n].clear();
      for (const test::LampBall& ball : balls) {
        const Vec3d toward = ball.position - places_[n];
        LampSighting lamp;
        lamp.direction = toward.normalized();
        if (error_rad > 0)
          lamp.direction =
              (lamp.direction + Vec3d(error(random_), error(random_), error(random_))).normalized();
        lamp.illuminance = ball.intensity / toward.squaredNorm();
        lamp.angular_radius_rad = std::asin(ball.radius_m / toward.norm());
        lamps_[n].push_back(lamp);
      }
      seen_.push_back({places_[n], true, kPi / 2, lamps_[n]});
    }
    return seen_;
  }
  std::vector<LampSighting>& of(std::size_t probe) { return lamps_[probe]; }
  // After of() was changed.
  std::span<const ProbeSightings> again() {
    for (std::size_t n = 0; n < places_.size(); ++n) seen_[n].lamps = lamps_[n];
    return seen_;
  }

 private:
  std::vector<Vec3d> places_;
  std::vector<std::vector<LampSighting>> lamps_;
  std::vector<ProbeSightings> seen_;
  std::mt19937 random_{11};
};

TEST(Triangulation, StatedUncertaintyIsThatOfNoisyRays) {
  const Vec3d truth(0.4, 2.5, 0.7);
  std::mt19937 random(1);
  std::normal_distribution<double> error(0, 0.4 * kDegree);
  double squares = 0, stated = 0;
  constexpr int kTrials = 500;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<SightRay> rays;
    for (const Vec3d& from : kPlaces)
      rays.push_back(
          {from,
           ((truth - from).normalized() + Vec3d(error(random), error(random), error(random))).normalized()});
    const auto place = triangulate(rays, {1, 1, 1});
    ASSERT_TRUE(place);
    squares += (place->position - truth).squaredNorm();
    stated += place->sigma_m * place->sigma_m;
  }
  // The worst axis is at most all of the error, and at least a third of it.
  EXPECT_LT(squares, 3 * stated * 1.2);
  EXPECT_GT(squares,
            stated / 1.4);  // it is stated with the scatter where that is above the least of .4 degrees
}

TEST(Triangulation, WhatRaysDoNotDetermineIsRefused) {
  const SightRay one{{0, 0, 0}, {0, 1, 0}};
  EXPECT_FALSE(triangulate(std::vector{one}, {0, 1, 0}));
  EXPECT_FALSE(triangulate(std::vector{one, one}, {0, 1, 0}));
  EXPECT_FALSE(meeting_point(one, {{1, 0, 0}, {0, 1, 0}}, 0.1));                    // parallel
  EXPECT_FALSE(meeting_point(one, {{1, 0, 0}, Vec3d(1, 1, 0).normalized()}, 0.1));  // behind
  const auto met = meeting_point(one, {{1, 0, 0}, Vec3d(-1, 1, 0).normalized()}, 0.1);
  ASSERT_TRUE(met);
  EXPECT_LT((*met - Vec3d(0, 1, 0)).norm(), 1e-12);
}

TEST(LampTracks, PlacesLampsWithTheirIntensityAndSize) {
  Probes probes;
  LampTracks tracks;
  const std::vector<test::LampBall> balls = {{{0.5, 2, 0.5}, 0.05, Rgbd(100, 90, 80)},
                                             {{1.7, 2.5, 1.2}, 0.03, Rgbd(40, 50, 60)}};
  tracks.update(probes.see(balls), 0);
  ASSERT_EQ(tracks.lamps().size(), 2u);
  for (const test::LampBall& ball : balls) {
    const auto found = std::find_if(tracks.lamps().begin(), tracks.lamps().end(), [&](const LampTrack& t) {
      return (t.position - ball.position).norm() < 1e-3;
    });
    ASSERT_NE(found, tracks.lamps().end());
    EXPECT_TRUE((found->intensity - ball.intensity).abs().maxCoeff() < 0.2);
    EXPECT_NEAR(found->radius_m, ball.radius_m, 1e-4);
    EXPECT_EQ(found->weight, 1);
  }
}

TEST(LampTracks, KeepIdsAndWeightWhileLampsMoveAndRaysShake) {
  Probes probes;
  LampTracks tracks;
  std::vector<std::uint32_t> ids;
  for (int frame = 0; frame < 90; ++frame) {
    const double t = frame / 30.0;
    // .5 m/s, a second lamp that passes before the first.
    tracks.update(probes.see({{{0.5, 2, 0.3 + 0.5 * t}, 0.03, Rgbd::Constant(100)},
                              {{1.8 - 0.6 * t, 2.6, 1}, 0.03, Rgbd::Constant(60)}},
                             0.1 * kDegree),
                  1 / 30.0);
    ASSERT_EQ(tracks.lamps().size(), 2u) << frame;
    if (ids.empty()) ids = {tracks.lamps()[0].id, tracks.lamps()[1].id};
    EXPECT_EQ(tracks.lamps()[0].id, ids[0]);
    EXPECT_EQ(tracks.lamps()[1].id, ids[1]);
    for (const LampTrack& lamp : tracks.lamps()) EXPECT_EQ(lamp.weight, 1) << frame;
  }
}

TEST(LampTracks, NewLampsFadeInAndOldOnesGo) {
  Probes probes;
  LampTracks tracks;
  const test::LampBall ball{{0.5, 2, 0.5}, 0.03, Rgbd::Constant(100)};
  tracks.update(probes.see({}), 0);
  tracks.update(probes.see({ball}), 0.1);
  ASSERT_EQ(tracks.lamps().size(), 1u);
  EXPECT_EQ(tracks.lamps()[0].weight, 0);
  tracks.update(probes.see({ball}), 0.1);
  EXPECT_NEAR(tracks.lamps()[0].weight, 0.1 / LampTracks::kFade_s, 1e-9);
  for (int i = 0; i < 10; ++i) tracks.update(probes.see({ball}), 0.1);
  EXPECT_EQ(tracks.lamps()[0].weight, 1);
  tracks.update(probes.see({}), 0.1);  // switched off: no probe sees any of it, at once
  ASSERT_EQ(tracks.lamps().size(), 1u);
  for (const auto& link : tracks.lamps()[0].links) EXPECT_EQ(luminance(link.intensity), 0);
  for (int i = 0; i < 10; ++i) tracks.update(probes.see({}), 0.1);
  EXPECT_TRUE(tracks.lamps().empty());
}

TEST(LampTracks, WhoDoesNotSeeALampIsInItsShade) {
  Probes probes;
  LampTracks tracks;
  probes.see({{{0.5, 2, 0.5}, 0.03, Rgbd::Constant(100)}});
  probes.of(3).clear();
  tracks.update(probes.again(), 0);
  ASSERT_EQ(tracks.lamps().size(), 1u);
  EXPECT_TRUE(tracks.lamps()[0].links[3].known);
  EXPECT_EQ(luminance(tracks.lamps()[0].links[3].intensity), 0);
  EXPECT_NEAR(luminance(tracks.lamps()[0].links[0].intensity), 100, 1e-6);
}

TEST(LampTracks, FarLampsOneProbeAndProbesInLineWithALampDetermineNothing) {
  LampTracks far;
  Probes probes;
  far.update(probes.see({{{100, 300, 50}, 1, Rgbd::Constant(1e7)}}), 0);
  EXPECT_TRUE(far.lamps().empty());
  LampTracks alone;
  Probes one({{0, 0, 0}});
  alone.update(one.see({{{0.5, 2, 0.5}, 0.03, Rgbd::Constant(100)}}), 0);
  EXPECT_TRUE(alone.lamps().empty());
  LampTracks line;
  Probes in_line({{0, 0, 0}, {0, 0.5, 0}, {0, 1, 0}});
  line.update(in_line.see({{{0, 2, 0}, 0.03, Rgbd::Constant(100)}}), 0);
  EXPECT_TRUE(line.lamps().empty());
}

TEST(LampTracks, LampsThatOneProbeSeesAsOneShareItsRay) {
  // The first probe stands below both.
  Probes probes({{1, 0, 1}, {0, 0, 0}, {2, 0, 0}, {0, 0, 2}, {2, 0, 2}});
  const std::vector<test::LampBall> balls = {{{1, 2, 1}, 0.03, Rgbd::Constant(100)},
                                             {{1, 3, 1}, 0.03, Rgbd::Constant(90)}};
  LampTracks tracks;
  probes.see(balls);
  probes.of(0)[0].illuminance += probes.of(0)[1].illuminance;
  probes.of(0).resize(1);
  for (int i = 0; i < 5; ++i) tracks.update(probes.again(), 0.1);
  ASSERT_EQ(tracks.lamps().size(), 2u);
  double shares = 0;
  for (const LampTrack& lamp : tracks.lamps()) shares += lamp.links[0].share;
  EXPECT_NEAR(shares, 1, 1e-9);
  for (const LampTrack& lamp : tracks.lamps())
    EXPECT_NEAR(luminance(lamp.intensity), lamp.position.y() < 2.5 ? 100 : 90, 3);
}

// More probes than are paired in one update: all pairs have their turn.
TEST(LampTracks, AnyTwoOfManyProbesFindWhatTheyAloneSee) {
  constexpr std::size_t kMany = 50;
  std::vector<Vec3d> places;
  for (std::size_t n = 0; n < kMany; ++n)
    places.emplace_back(0.4 * static_cast<double>(n % 10), 0, 0.4 * static_cast<double>(n / 10));
  const test::LampBall ball{{1.8, 2, 1.1}, 0.03, Rgbd::Constant(100)};
  for (const auto& [a, b] : {std::pair{0u, 49u}, {7u, 20u}, {3u, 41u}, {12u, 15u}}) {
    Probes probes(places);
    LampTracks tracks;
    tracks.update(probes.see({}), 0);
    std::vector<ProbeSightings> seen;
    for (const ProbeSightings& probe : probes.see({ball})) seen.push_back(probe);
    for (std::size_t n = 0; n < kMany; ++n)
      if (n != a && n != b) {
        seen[n].lamps = {};
        seen[n].theta_max_rad = 0.05;  // looks elsewhere
      }
    for (int frame = 0; frame < 4; ++frame) tracks.update(seen, 1 / 30.0);
    ASSERT_EQ(tracks.lamps().size(), 1u) << a << " " << b;
    EXPECT_LT((tracks.lamps()[0].position - ball.position).norm(), 1e-6);
  }
}

TEST(LampFinder, MeasuresSmallLampsAnywhereInTheMap) {
  const SpherePartition sphere(384);
  const PolarCells cells({}, sphere);
  LampFinder finder(cells);
  std::vector<LampSighting> lamps;
  // Near the zenith, across the seam of azimuth 0, and low.
  for (const Vec3d& toward : {Vec3d(0.02, 1, 0.01), Vec3d(0.005, 1, 1), Vec3d(-2, 0.4, 0.1)}) {
    const test::LampBall ball{2 * toward, 0.05, Rgbd(100, 80, 60)};
    finder.find(test::map_at({test::walls, {ball}}, Vec3d::Zero()), lamps);
    ASSERT_EQ(lamps.size(), 1u);
    EXPECT_GT(lamps[0].direction.dot(toward.normalized()), std::cos(0.3 * kDegree));
    const Rgbd lux = ball.intensity / ball.position.squaredNorm();
    EXPECT_LT(((lamps[0].illuminance - lux) / lux).abs().maxCoeff(), 0.01);
    EXPECT_NEAR(lamps[0].angular_radius_rad, std::asin(0.05 / ball.position.norm()), 0.5 * kDegree);
  }
}

TEST(LampFinder, NoLampInWallsWindowsDarknessAndNan) {
  const SpherePartition sphere(384);
  const PolarCells cells({}, sphere);
  LampFinder finder(cells);
  std::vector<LampSighting> lamps;
  finder.find(test::map_at({test::walls, {}}, Vec3d::Zero()), lamps);
  EXPECT_TRUE(lamps.empty());
  // A bright half of the sky.
  finder.find(
      test::map_at({[](const Vec3d&, const Vec3d& d) { return Rgbd::Constant(d.x() > 0 ? 100 : 1); }, {}},
                   Vec3d::Zero()),
      lamps);
  EXPECT_TRUE(lamps.empty());
  PolarMap map = PolarMap::make({}, 1);
  finder.find(map, lamps);
  EXPECT_TRUE(lamps.empty());
  std::fill(map.radiance.begin(), map.radiance.end(), std::numeric_limits<float>::quiet_NaN());
  finder.find(map, lamps);
  EXPECT_TRUE(lamps.empty());
}

}  // namespace
}  // namespace lightwell
