// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/main_lights.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

namespace lightwell {
namespace {

struct Lamp {
  Vec3d direction;
  std::function<Rgbd(const Vec3d&)> illuminance;
};

LightField field_of(const std::vector<Lamp>& lamps, const Rgbd& ambient, int degree = 4,
                    std::array<int, 3> size = {5, 3, 6}) {
  LightField field;
  field.grid = {size, Vec3d(-1, 0, -1), Vec3d(1, 1, 1)};
  field.degree = degree;
  field.radiance.assign(field.grid.points() * 3 * static_cast<std::size_t>(field.harmonics()), 0.0f);
  field.confidence.assign(field.grid.points(), 1.0f);
  std::vector<double> y(static_cast<std::size_t>(field.harmonics()));
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j)
      for (int i = 0; i < size[0]; ++i)
        for (int c = 0; c < 3; ++c) {
          const auto at = static_cast<std::size_t>(j * size[0] + i);
          field.plane(k, 0, c)[at] += static_cast<float>(std::sqrt(4 * kPi) * ambient[c]);
          for (const Lamp& lamp : lamps) {
            harmonics(lamp.direction.normalized(), degree, y.data());
            const double lux = lamp.illuminance(field.grid.position(i, j, k))[c];
            for (int h = 0; h < field.harmonics(); ++h)
              field.plane(k, h, c)[at] += static_cast<float>(lux * y[static_cast<std::size_t>(h)]);
          }
        }
  return field;
}

MainLights found(const LightField& field, int count) {
  return find_main_lights(field, count, field.grid.low, field.grid.high);
}

// A spot that lights one side only, in a room that shines: the pattern of the spot is found, and nothing of the room.
TEST(MainLights, ASpotAndItsPatternAreFound) {
  const Lamp spot{Vec3d(0.3, 0.8, -0.2), [](const Vec3d& p) {
                    return p.x() > 0.1 ? Rgbd(300, 200, 100 * (1 + p.z())) : Rgbd(Rgbd::Zero());
                  }};
  const LightField field = field_of({spot}, Rgbd(2, 3, 4));
  const MainLights lights = found(field, 4);
  ASSERT_EQ(lights.directions.size(), 1u);
  EXPECT_GT(lights.directions[0].dot(spot.direction.normalized()), std::cos(0.2 * kPi / 180));
  for (int k = 0; k < 6; ++k)
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 5; ++i)
        for (int c = 0; c < 3; ++c)
          EXPECT_NEAR(static_cast<double>(lights.plane(0, k, c, field.grid)[j * 5 + i]),
                      spot.illuminance(field.grid.position(i, j, k))[c], 0.02);
}

// Only some points of a large grid are asked: of every column, row and slab, whatever the grid's size.
TEST(MainLights, ABeamIsFoundOnGridsOfEverySize) {
  const Lamp beam{Vec3d(0.2, 0.9, 0.1),
                  [](const Vec3d& p) { return Rgbd::Constant(std::abs(p.x()) < 0.6 ? 300.0 : 0.0); }};
  for (const std::array<int, 3> size : {std::array{50, 8, 50}, std::array{50, 40, 10}, std::array{64, 4, 32},
                                        std::array{20, 20, 20}, std::array{100, 2, 30}})
    EXPECT_EQ(found(field_of({beam}, Rgbd::Ones(), 2, size), 1).directions.size(), 1u) << size[0];
}

TEST(MainLights, SeveralLightsAreToldApart) {
  std::vector<Lamp> lamps;
  for (const Vec3d& d : {Vec3d(1, 1, 0), Vec3d(-1, 1, 0.5), Vec3d(0, 0.2, -1)})
    lamps.push_back({d, [d](const Vec3d& p) { return Rgbd::Constant(50 + 20 * d.dot(p)); }});
  const MainLights lights = found(field_of(lamps, Rgbd::Constant(1)), 3);
  ASSERT_EQ(lights.directions.size(), 3u);
  for (const Lamp& lamp : lamps) {
    double nearest = -1;
    for (const Vec3d& d : lights.directions) nearest = std::max(nearest, d.dot(lamp.direction.normalized()));
    EXPECT_GT(nearest, std::cos(1.0 * kPi / 180));
  }
}

TEST(MainLights, EvenLightAndNoLightHaveNone) {
  EXPECT_TRUE(found(field_of({}, Rgbd(1, 2, 3)), 4).directions.empty());
  EXPECT_TRUE(found(field_of({}, Rgbd::Zero()), 4).directions.empty());
  EXPECT_TRUE(found(field_of({}, Rgbd::Ones()), 0).illuminance.empty());
}

// A sky that is brighter on one side: no illuminance is negative, and none takes more than there is.
TEST(MainLights, WhatIsNotALightGivesNoNegativeOne) {
  LightField field = field_of({}, Rgbd::Constant(1));
  for (int k = 0; k < 6; ++k)
    for (int c = 0; c < 3; ++c)
      for (std::size_t at = 0; at < 15; ++at)
        field.plane(k, harmonic_index(1, c - 1), c)[at] = 2.0f - static_cast<float>(k);
  const MainLights lights = found(field, 8);
  for (const float lux : lights.illuminance) EXPECT_GE(lux, 0);
}

// Lamps outside the box that is asked do not draw lights to them.
TEST(MainLights, OnlyPointsInTheBoxAreAsked) {
  const auto on = [](double low, double high) {
    return [=](const Vec3d& p) { return Rgbd::Constant(p.z() >= low && p.z() <= high ? 100.0 : 0.0); };
  };
  const LightField field =
      field_of({{Vec3d(1, 1, 0), on(-1, -0.5)}, {Vec3d(-1, 1, 0), on(0.5, 1)}}, Rgbd::Zero());
  const MainLights lights = find_main_lights(field, 4, Vec3d(-1, 0, 0.5), Vec3d(1, 1, 1));
  ASSERT_EQ(lights.directions.size(), 1u);
  EXPECT_LT(lights.directions[0].x(), -0.5);
}

}  // namespace
}  // namespace lightwell
