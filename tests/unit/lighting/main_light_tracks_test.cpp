// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/main_light_tracks.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "lighting/field/main_light_search.h"

namespace lightwell {
namespace {

constexpr double kDt_s = 1.0 / 30;

struct Lamp {
  Vec3d direction;
  double lux = 100;
};

// Lamps that are the same everywhere, in an even sky; noise: of every number, relative to the sky's first harmonic.
LightField field_of(const std::vector<Lamp>& lamps, double ambient = 1, double noise = 0, unsigned seed = 1) {
  LightField field;
  field.grid = {{4, 3, 5}, Vec3d(-1, 0, -1), Vec3d(1, 1, 1)};
  field.degree = 4;
  field.radiance.resize(field.grid.points() * 75);
  field.confidence.assign(field.grid.points(), 1.0f);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, noise);
  double y[25];
  for (int k = 0; k < 5; ++k)
    for (int h = 0; h < 25; ++h)
      for (int c = 0; c < 3; ++c)
        for (std::size_t at = 0; at < 12; ++at) {
          double sum = (h == 0 ? std::sqrt(4 * kPi) * ambient : 0) + normal(random);
          for (const Lamp& lamp : lamps) {
            harmonics(lamp.direction.normalized(), 4, y);
            sum += lamp.lux * y[h];
          }
          field.plane(k, h, c)[at] = static_cast<float>(sum);
        }
  return field;
}

const MainLights& update(MainLightTracks& tracks, const LightField& field) {
  return tracks.update(field, kDt_s, field.grid.low, field.grid.high);
}

double lux_of(const MainLights& lights, int i, const LightField& field) {
  return static_cast<double>(*lights.plane(i, 0, 0, field.grid));
}

double degrees(const Vec3d& a, const Vec3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / kPi;
}

TEST(MainLightSearch, PowersAreTheNonnegativeLeastSquaresOfEachPoint) {
  const std::vector<Vec3d> directions = {Vec3d(1, 1, 0).normalized(), Vec3d(0.8, 1, 0.3).normalized(),
                                         Vec3d(-1, 0.2, 1).normalized()};
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd points = Eigen::MatrixXd::NullaryExpr(25, 200, [&] { return normal(random); });
  points.row(0).array() += 2;
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(25, 4);
  columns(0, 0) = std::sqrt(4 * kPi);
  for (int i = 0; i < 3; ++i)
    harmonics(directions[static_cast<std::size_t>(i)], 4, columns.col(i + 1).data());
  const Eigen::MatrixXd x = MainLightBasis(directions, 4).powers(points);
  int held = 0, free = 0;
  for (Eigen::Index p = 0; p < 200; ++p) {
    // The conditions of Karush, Kuhn and Tucker.
    const Eigen::VectorXd slope = columns.transpose() * (columns * x.col(p) - points.col(p));
    for (int i = 0; i < 4; ++i) {
      EXPECT_GE(x(i, p), 0);
      if (x(i, p) > 0) {
        EXPECT_NEAR(slope[i], 0, 1e-9);
      } else {
        EXPECT_GE(slope[i], -1e-9);
      }
      (x(i, p) > 0 ? free : held) += 1;
    }
  }
  EXPECT_GT(held, 100);  // both ways were taken
  EXPECT_GT(free, 100);
}

TEST(MainLightSearch, AWeightIsThePartOfItsIlluminanceThatALightAloneHas) {
  const Vec3d d = Vec3d(0.2, 1, 0.4).normalized();
  Eigen::MatrixXd point(25, 1);
  harmonics(d, 4, point.data());
  point *= 70;
  point(0, 0) = 0;  // so that no ambient term takes what the light leaves
  const double alone = MainLightBasis({&d, 1}, 4).powers(point)(1, 0);
  for (const double weight : {0.001, 0.3, 0.9}) {
    const double weights[] = {weight};
    EXPECT_NEAR(MainLightBasis({&d, 1}, 4, weights).powers(point)(1, 0), weight * alone, 1e-9 * alone);
  }
}

TEST(MainLightTracks, BeginWithTheMainLightsOfTheFirstFieldThatHasLight) {
  const LightField field = field_of({{Vec3d(1, 1, 0)}, {Vec3d(-1, 1, 0.5), 60}});
  MainLightTracks tracks(4);
  update(tracks, field_of({}, 0));
  EXPECT_EQ(tracks.weights(), (std::vector<double>{0, 0, 0, 0}));
  const MainLights& lights = update(tracks, field);
  const MainLights expected = find_main_lights(field, 4, field.grid.low, field.grid.high);
  ASSERT_EQ(expected.directions.size(), 2u);
  EXPECT_EQ(tracks.weights(), (std::vector<double>{1, 1, 0, 0}));
  ASSERT_EQ(lights.directions.size(), 4u);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(lights.directions[i], expected.directions[i]);
  for (std::size_t i = 0; i < lights.illuminance.size(); ++i)
    ASSERT_EQ(lights.illuminance[i], i < expected.illuminance.size() ? expected.illuminance[i] : 0);
}

TEST(MainLightTracks, ALampThatMovesIsFollowedByTheSameLight) {
  MainLightTracks tracks(4);
  const Vec3d still = Vec3d(-0.5, 1, -1).normalized();
  Vec3d shown = Vec3d::Zero();
  for (int n = 0; n < 90; ++n) {  // 30 degrees a second
    const double turn = n * kPi / 180;
    const Vec3d moving(std::sin(turn) * 0.8, 0.6, std::cos(turn) * 0.8);
    const LightField field = field_of({{moving, 200}, {still, 80}});
    const MainLights& lights = update(tracks, field);
    // The stronger one was found first. It is behind by the time that it takes to settle, and never jumps.
    EXPECT_LT(degrees(lights.directions[0], moving), 30 * 0.1 + 1) << n;
    if (n > 0) {
      EXPECT_LT(degrees(lights.directions[0], shown), 2) << n;
    }
    shown = lights.directions[0];
    EXPECT_LT(degrees(lights.directions[1], still), 1.5) << n;
    EXPECT_EQ(tracks.weights(), (std::vector<double>{1, 1, 0, 0})) << n;
  }
}

TEST(MainLightTracks, NoiseMovesNothing) {
  MainLightTracks tracks(2);
  const std::vector<Lamp> lamps = {{Vec3d(0.4, 1, 0.2), 100}};
  update(tracks, field_of(lamps));
  const Vec3d first = tracks.update(field_of(lamps), kDt_s, Vec3d(-1, 0, -1), Vec3d(1, 1, 1)).directions[0];
  for (unsigned n = 0; n < 60; ++n)
    EXPECT_EQ(update(tracks, field_of(lamps, 1, 0.5, n)).directions[0], first) << n;
}

// Half a second, no step larger than its part of it.
TEST(MainLightTracks, ALampThatComesFadesInAndTheOthersGiveWayEvenly) {
  MainLightTracks tracks(3);
  const Lamp first{Vec3d(1, 1, 0), 100}, second{Vec3d(-0.2, 1, 0.6), 80};
  for (int n = 0; n < 5; ++n) update(tracks, field_of({first}));
  const LightField field = field_of({first, second});
  double last = 0, last_first = lux_of(update(tracks, field), 0, field);
  for (int n = 0; n < 30; ++n) {
    const MainLights& lights = update(tracks, field);
    const double lux = lux_of(lights, 1, field), of_first = lux_of(lights, 0, field);
    EXPECT_LT(std::abs(lux - last), 80 * 2.5 * kDt_s / MainLightTracks::kFade_s) << n;
    EXPECT_LT(std::abs(of_first - last_first), 100 * 2.5 * kDt_s / MainLightTracks::kFade_s) << n;
    last = lux;
    last_first = of_first;
  }
  EXPECT_NEAR(last, 80, 2);
  EXPECT_NEAR(last_first, 100, 2);
  EXPECT_LT(
      degrees(tracks.update(field, kDt_s, field.grid.low, field.grid.high).directions[1], second.direction),
      1);
}

// A lamp that goes out has no shadow from that field on; another one takes the place that it leaves.
TEST(MainLightTracks, ALampThatGoesLeavesItsPlaceToAnother) {
  MainLightTracks tracks(1);
  const Lamp first{Vec3d(1, 1, 0), 100}, second{Vec3d(-1, 0.5, 0.3), 90};
  const LightField before = field_of({first}), after = field_of({second});
  EXPECT_NEAR(lux_of(update(tracks, before), 0, before), 100, 1);
  EXPECT_LT(lux_of(update(tracks, after), 0, after), 5);
  for (int n = 0; n < 60; ++n) update(tracks, after);
  EXPECT_NEAR(lux_of(update(tracks, after), 0, after), 90, 1);
  EXPECT_LT(degrees(update(tracks, after).directions[0], second.direction), 1);
}

TEST(MainLightTracks, AStrongerLampTakesThePlaceOfTheWeakest) {
  MainLightTracks tracks(1);
  const Lamp weak{Vec3d(1, 1, 0), 50}, strong{Vec3d(-1, 0.5, 0.3), 200};
  update(tracks, field_of({weak}));
  const LightField both = field_of({weak, strong});
  for (int n = 0; n < 60; ++n) update(tracks, both);
  EXPECT_LT(degrees(update(tracks, both).directions[0], strong.direction), 5);
  EXPECT_EQ(tracks.weights()[0], 1);
}

TEST(MainLightTracks, DarknessForgetsNothing) {
  MainLightTracks tracks(2);
  const std::vector<Lamp> lamps = {{Vec3d(0.4, 1, 0.2)}};
  const Vec3d first = update(tracks, field_of(lamps)).directions[0];
  for (int n = 0; n < 60; ++n) {
    const MainLights& dark = update(tracks, field_of({}, 0));
    for (const float lux : dark.illuminance) EXPECT_EQ(lux, 0);
  }
  const LightField field = field_of(lamps);
  EXPECT_NEAR(lux_of(update(tracks, field), 0, field), 100, 1);
  EXPECT_EQ(update(tracks, field).directions[0], first);
}

TEST(MainLightTracks, AnotherGridAndDegreeAndNoLightsAtAll) {
  MainLightTracks tracks(2), none(0);
  update(tracks, field_of({{Vec3d(0.4, 1, 0.2)}}));
  LightField small;
  small.degree = 1;
  small.radiance.assign(8 * 12, 1.0f);
  small.confidence.assign(8, 1.0f);
  EXPECT_EQ(update(tracks, small).illuminance.size(), 2u * 3 * 8);
  EXPECT_TRUE(update(none, small).illuminance.empty());
  EXPECT_TRUE(update(none, small).directions.empty());
}

}  // namespace
}  // namespace lightwell
