// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/live_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/support/live_stage.h"

namespace lightwell {
namespace {

using test::LampBall;
using test::StageLight;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

const StageLight kWalls = {test::walls, {}};
const StageLight kLamp = {test::walls, {{{0.6, 1.8, 0.3}, 0.04, Rgbd(20, 18, 15)}}};

LiveFieldOptions options_of(int side = 16) {
  LiveFieldOptions options;
  options.grid = {{side, side, side}, Vec3d::Zero(), Vec3d::Ones()};
  return options;
}

struct Errors {
  double live = 0, baseline = 0;
};
// Of the harmonics at 30 places, relative; all probes see the light twice.
Errors errors_of(const StageLight& light, const std::vector<Vec3d>& positions,
                 LiveFieldOptions options = options_of()) {
  LiveField live(options, positions);
  std::vector<Eigen::MatrixXd> own;
  for (std::size_t n = 0; n < positions.size(); ++n) {
    const PolarMap map = test::map_at(light, positions[n]);
    own.emplace_back(MapHarmonics(map.grid).project(map).matrix());
    live.update(n, map, 0);
    live.update(n, map, 0.03);
  }
  const LightField& field = live.make(0.03);
  double error = 0, baseline = 0, norm = 0;
  for (const Vec3d& p : test::random_positions(30, 99)) {
    const Eigen::MatrixXd exact = test::exact_harmonics(light, p);
    error += (light_at(field, p).radiance.matrix() - exact).squaredNorm();
    baseline += (test::shepard(positions, own, p) - exact).squaredNorm();
    norm += exact.squaredNorm();
  }
  return {std::sqrt(error / norm), std::sqrt(baseline / norm)};
}

// Bounds: what was measured with other places and other light, and a third more.
TEST(LiveField, InterpolatesAcrossDirectionsBetterThanByPlace) {
  const auto places = test::random_positions(10, 1);
  const Errors linear = errors_of({test::linear_field, {}}, places);
  EXPECT_LT(linear.live, 0.02);
  EXPECT_LT(linear.live, linear.baseline / 5);
  const Errors walls = errors_of(kWalls, places);
  EXPECT_LT(walls.live, 0.75 * walls.baseline);
  const Errors beam = errors_of({test::beam_edge, {}}, places);
  EXPECT_LT(beam.live, 0.8 * beam.baseline);
  const Errors area = errors_of({test::box_of_lamps, {}}, places);
  EXPECT_LT(area.live, 0.7 * area.baseline);
}

TEST(LiveField, NearLampsMoveAndFadeAsNearLampsDo) {
  const auto places = test::random_positions(10, 2);
  const Errors one = errors_of(kLamp, places);
  EXPECT_LT(one.live, 0.03);
  EXPECT_GT(one.baseline, 0.3);
  // Two in line above the middle.
  EXPECT_LT(
      errors_of({test::walls,
                 {{{0.5, 1.6, 0.5}, 0.04, Rgbd(20, 18, 15)}, {{0.5, 2.4, 0.5}, 0.04, Rgbd::Constant(30)}}},
                places)
          .live,
      0.04);
  // Probes on a table see it as well.
  auto table = places;
  for (Vec3d& p : table) p.y() = 0.3;
  EXPECT_LT(errors_of(kLamp, table).live, 0.03);
}

TEST(LiveField, IsWhatAProbeMeasuredAtItsPlace) {
  std::vector<Vec3d> places = test::random_positions(6, 3);
  places[0] = options_of().grid.position(5, 7, 9);
  for (const StageLight& light : {kWalls, kLamp}) {
    LiveField live(options_of(), places);
    for (std::size_t n = 0; n < places.size(); ++n) live.update(n, test::map_at(light, places[n]), 0);
    const Eigen::MatrixXd at_probe = light_at(live.make(0), places[0]).radiance.matrix();
    const Eigen::MatrixXd own = MapHarmonics(PolarGrid{}).project(test::map_at(light, places[0])).matrix();
    // A ray meets the plane between its pixels; a lamp's place has an error.
    EXPECT_LT((at_probe - own).norm(), 0.02 * own.norm());
  }
}

TEST(LiveField, OneProbeGivesItsLightEverywhereAndTwoAndLinesAreFinite) {
  LiveField one(options_of(4), {{0.3, 0.3, 0.3}});
  const PolarMap map = test::map_at(kLamp, {0.3, 0.3, 0.3});
  one.update(0, map, 0);
  const Eigen::MatrixXd own = MapHarmonics(map.grid).project(map).matrix();
  for (const Vec3d& p : test::random_positions(5, 4))
    EXPECT_LT((light_at(one.make(0), p).radiance.matrix() - own).norm(), 1e-4 * own.norm());
  for (const std::vector<Vec3d>& places : {std::vector<Vec3d>{{0, 0, 0}, {1, 0.5, 1}},
                                           {{0, 0.5, 0}, {0.5, 0.5, 0.5}, {1, 0.5, 1}},
                                           {{0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}}}) {
    const Errors errors = errors_of(kWalls, places);
    EXPECT_LT(errors.live, 0.5);  // NaN fails
  }
}

TEST(LiveField, DarknessIsDarkAndNothingHeardIsUnknown) {
  LiveField live(options_of(4), {{0, 0, 0}, {1, 1, 1}});
  EXPECT_EQ(live.make(0).confidence[0], 0);
  EXPECT_EQ(live.make(0.1).radiance[0], 0);
  const PolarMap dark = PolarMap::make({}, 1);
  live.update(0, dark, 0.2);
  live.update(1, dark, 0.2);
  const LightField& field = live.make(0.2);
  EXPECT_TRUE(std::all_of(field.radiance.begin(), field.radiance.end(), [](float v) { return v == 0; }));
  // Half of the sphere at the probe itself, and no more anywhere: the lower half was not measured.
  EXPECT_NEAR(field.confidence[0], 0.5, 0.02);
  EXPECT_LE(*std::max_element(field.confidence.begin(), field.confidence.end()), 0.51f);
}

TEST(LiveField, WhatIsNotFiniteWasNotMeasured) {
  auto places = test::random_positions(8, 5);
  LiveField with(options_of(8), places),
      without(options_of(8), std::vector(places.begin(), places.end() - 1));
  for (std::size_t n = 0; n + 1 < places.size(); ++n) {
    with.update(n, test::map_at(kWalls, places[n]), 0);
    without.update(n, test::map_at(kWalls, places[n]), 0);
  }
  PolarMap broken = test::map_at(kWalls, places.back());
  std::fill(broken.radiance.begin(), broken.radiance.end(), kNan);
  with.update(places.size() - 1, broken, 0);
  const LightField& a = with.make(0);
  const LightField& b = without.make(0);
  double apart = 0, norm = 0;
  for (std::size_t i = 0; i < a.radiance.size(); ++i) {
    ASSERT_TRUE(std::isfinite(a.radiance[i]));
    apart += std::pow(static_cast<double>(a.radiance[i] - b.radiance[i]), 2);
    norm += std::pow(static_cast<double>(b.radiance[i]), 2);
  }
  // Not 0: the spread of the places, which scales the prior, is another one.
  EXPECT_LT(std::sqrt(apart / norm), 0.02);
}

TEST(LiveField, LampsInsideTheGridAndOnAProbeStayFinite) {
  auto places = test::random_positions(8, 6);
  places[0] = {0.5, 0.5, 0.5};
  for (const Vec3d& at : {Vec3d(0.5, 0.5, 0.5), Vec3d(0.51, 0.52, 0.5), Vec3d(0.5, 0.9, 0.5),
                          Vec3d(7.0 / 15, 7.0 / 15, 7.0 / 15)}) {
    LiveField live(options_of(), places);
    const StageLight light = {test::walls, {{at + Vec3d(0, 1e-9, 0), 0.03, Rgbd::Constant(3)}}};
    for (std::size_t n = 0; n < places.size(); ++n) live.update(n, test::map_at(light, places[n]), 0);
    const LightField& field = live.make(0);
    // Never above what half a cell's distance would have, times Y_00 and a little for the walls.
    const double most = 3 / std::pow(1.0 / 30, 2);
    for (const float v : field.radiance) ASSERT_LT(std::abs(v), most * 1.5);
  }
}

TEST(LiveField, SilentProbesFadeWithoutAJumpAndComeBack) {
  const auto places = test::random_positions(5, 7);
  LiveFieldOptions options = options_of(6);
  options.hold_s = 0.5;
  options.fade_s = 1;
  LiveField live(options, places);
  std::vector<PolarMap> maps;
  for (const Vec3d& p : places) maps.push_back(test::map_at(kWalls, p));
  for (float& v : maps[2].radiance) v *= 3;  // one that differs, whose going shows
  std::vector<float> before;
  double most = 0, all = 0;
  constexpr double kFrame = 1 / 30.0;
  for (int frame = 0; frame < 120; ++frame) {
    const double t = frame * kFrame;
    for (std::size_t n = 0; n < places.size(); ++n)
      if (n != 2 || frame == 0 || t > 2.5) live.update(n, maps[n], t);
    const LightField& field = live.make(t);
    if (frame == 0) before = field.radiance;
    double change = 0, norm = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
      change += std::pow(static_cast<double>(field.radiance[i] - before[i]), 2);
      norm += std::pow(static_cast<double>(before[i]), 2);
    }
    most = std::max(most, std::sqrt(change / norm));
    all += std::sqrt(change / norm);
    before = field.radiance;
    if (t > 1.6 && t < 2.4) {
      EXPECT_EQ(live.weights()[2], 0);
    }
  }
  EXPECT_EQ(live.weights()[2], 1);
  EXPECT_GT(all, 0.3);           // it did show
  EXPECT_LT(most, all / 2 / 8);  // a second has 30 frames
}

TEST(LiveField, WhereAllAreSilentTheLastLightStaysUnknown) {
  LiveField live(options_of(4), test::random_positions(5, 9));
  const StageLight linear = {test::linear_field, {}};
  for (std::size_t n = 0; n < 5; ++n) live.update(n, test::map_at(linear, live.positions()[n]), 0);
  const LightField first = live.make(0);
  float known = first.confidence[20];
  EXPECT_GT(known, 0.1f);
  for (int frame = 1; frame < 100; ++frame) {
    const LightField& field = live.make(frame / 30.0);
    ASSERT_EQ(field.radiance, first.radiance) << frame;
    EXPECT_LE(field.confidence[20], known);
    if (frame == 45) {
      EXPECT_NEAR(field.confidence[20], first.confidence[20] / 2, 0.02f * first.confidence[20]);
    }
    known = field.confidence[20];
  }
  EXPECT_EQ(*std::max_element(live.make(4).confidence.begin(), live.make(4).confidence.end()), 0);
  // The first who is back does not throw the others' last light away.
  live.update(0, test::map_at(linear, live.positions()[0]), 4);
  const LightField& back = live.make(4);
  double change = 0, norm = 0;
  for (std::size_t i = 0; i < back.radiance.size(); ++i) {
    change += std::pow(static_cast<double>(back.radiance[i] - first.radiance[i]), 2);
    norm += std::pow(static_cast<double>(first.radiance[i]), 2);
  }
  EXPECT_LT(std::sqrt(change / norm), 1e-6);
  EXPECT_EQ(live.weights()[0], 1);
  EXPECT_EQ(live.weights()[1], 0);
  EXPECT_GT(back.confidence[20], 0);
}

// One with a wider lens falls silent: what it alone saw stays, at the places of all.
TEST(LiveField, DirectionsThatNobodySeesAnyMoreKeepTheirLight) {
  LiveField live(options_of(4), test::random_positions(3, 10));
  const StageLight even = {[](const Vec3d&, const Vec3d&) { return Rgbd::Constant(2); }, {}};
  const auto map = [&](std::size_t n, double reach) {
    return test::map_at(even, live.positions()[n], {45, 90, kPi / 2 * reach});
  };
  for (std::size_t n = 0; n < 3; ++n) live.update(n, map(n, n == 0 ? 1 : 0.6), 0);
  const LightField first = live.make(0);
  for (int frame = 1; frame < 100; ++frame) {
    for (std::size_t n = 1; n < 3; ++n) live.update(n, map(n, 0.6), frame / 30.0);
    const LightField& field = live.make(frame / 30.0);
    for (std::size_t i = 0; i < field.radiance.size(); ++i)
      ASSERT_NEAR(field.radiance[i], first.radiance[i], 0.02f * first.radiance[0]) << frame;
  }
  EXPECT_EQ(live.weights()[0], 0);
}

TEST(LiveField, MapsOfOtherSizesGoTogether) {
  const std::vector<Vec3d> places = test::random_positions(3, 8);
  LiveField live(options_of(4), places);
  const StageLight even = {[](const Vec3d&, const Vec3d&) { return Rgbd::Constant(2); }, {}};
  live.update(0, test::map_at(even, places[0], {45, 100, kPi / 2 * 0.8}), 0);
  live.update(1, test::map_at(even, places[1], {90, 360, kPi / 2}), 0);
  live.update(2, test::map_at(even, places[2], {10, 36, kPi / 2 * 0.5}), 0);
  const LightAtPoint light = light_at(live.make(0), {0.5, 0.5, 0.5});
  // An even upper half: L_00 = 2 √π L / 2, L_10 = 2π L √(3 / 4π) / 2.
  EXPECT_NEAR(light.radiance(0, 0), std::sqrt(kPi) * 2, 0.02);
  EXPECT_NEAR(light.radiance(2, 0), kPi * 2 * std::sqrt(3 / (4 * kPi)), 0.02);
}

}  // namespace
}  // namespace lightwell
