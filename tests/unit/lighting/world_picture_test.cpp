// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/world_picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lighting/direction.h"

namespace lightwell {
namespace {

constexpr double kDegree = kPi / 180;
const PolarGrid kGrid = {90, 360, kPi / 2};
const std::vector<bool> kAll(kGrid.size(), true);

// A hemisphere of one degree a bin, its light by direction.
template <class Light>
PolarMap map_of(const Light& light) {
  PolarMap map = PolarMap::make(kGrid, 3);
  for (int ring = 0; ring < 90; ++ring)
    for (int sector = 0; sector < 360; ++sector) {
      const Rgbd radiance = light(map.grid.bin_direction(ring, sector));
      for (int c = 0; c < 3; ++c)
        map.plane(c)[static_cast<std::size_t>(ring * 360 + sector)] = static_cast<float>(radiance[c]);
    }
  return map;
}

Rgbd smooth(const Vec3d& d) {
  return {2 + d.x(), 2 + d.y(), 2 + d.z()};
}

TEST(WorldPicture, UprightEveryBinIsThePixelThatLooksThere) {
  LatLongImage picture;
  WorldPicture(kGrid, kAll).paint_upright(map_of(smooth), picture);
  ASSERT_EQ(picture.width, 360);
  ASSERT_EQ(picture.height, 180);
  for (int y = 0; y < 180; ++y)
    for (int x = 0; x < 360; ++x) {
      const Rgb& pixel = picture.at(x, y);
      ASSERT_EQ(std::isnan(pixel.x()), y >= 90);
      const Rgbd light = smooth(direction_from_lat_long((x + 0.5) / 360, (y + 0.5) / 180));
      if (y < 90) {
        ASSERT_LE((pixel.cast<double>() - light).abs().maxCoeff(), 1e-5) << x << ", " << y;
      }
    }
}

TEST(WorldPicture, TurnedThePictureShowsTheWorldWhereTheProbeLooked) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(2.1, Vec3d::UnitY()) *
                                Eigen::AngleAxisd(0.7, Vec3d::UnitX()));
  // What the probe measures in its own frame of a world that is smooth.
  const PolarMap map = map_of([&](const Vec3d& d) { return smooth(turn * d); });
  LatLongImage picture;
  WorldPicture(kGrid, kAll).paint(map, turn, picture);
  double seen_sr = 0;
  for (int y = 0; y < 180; ++y)
    for (int x = 0; x < 360; ++x) {
      const Rgb& pixel = picture.at(x, y);
      const Vec3d direction = direction_from_lat_long((x + 0.5) / 360, (y + 0.5) / 180);
      const double above = std::asin((turn.conjugate() * direction).y());
      if (above < -kDegree) {
        ASSERT_TRUE(std::isnan(pixel.x())) << x << ", " << y;
      }
      if (above > kDegree) {
        ASSERT_FALSE(std::isnan(pixel.x())) << x << ", " << y;
      }
      if (std::isnan(pixel.x())) continue;
      seen_sr += picture.pixel_solid_angle_sr(y);
      // A piece's bin may lie a degree beside the pixel, and near the poles a few.
      ASSERT_LE((pixel.cast<double>() - smooth(direction)).abs().maxCoeff(), 1.5 * kDegree) << x << ", " << y;
    }
  EXPECT_NEAR(seen_sr / (2 * kPi), 1, 0.02);
}

TEST(WorldPicture, WhatTheSensorCutsOffIsNotSeenAndWhatHasNoPixelIs) {
  PolarMap map = map_of(smooth);
  std::vector<bool> seen = kAll;
  const std::size_t hole = 20 * 360 + 7, cut = 80 * 360 + 90;
  map.solid_angle_sr[hole] = map.solid_angle_sr[cut] = 0;
  seen[cut] = false;
  WorldPicture world(kGrid, seen);
  LatLongImage picture;
  for (const double turn_rad : {0.0, 1.0}) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(turn_rad, Vec3d::UnitY()));
    turn_rad > 0 ? world.paint(map, turn, picture) : world.paint_upright(map, picture);
    const auto toward = [&](std::size_t bin) {
      const Vec2d uv = lat_long_from_direction(
          turn * kGrid.bin_direction(static_cast<int>(bin / 360), static_cast<int>(bin % 360)));
      return picture.at(static_cast<int>(uv.x() * 360), static_cast<int>(uv.y() * 180));
    };
    EXPECT_NEAR(toward(hole).y(), map.rgb(hole).y(), 2 * kDegree);
    EXPECT_TRUE(std::isnan(toward(cut).x()) || turn_rad > 0) << "turned, a neighbour's piece may be there";
  }
}

TEST(WorldPicture, ATurnKeepsTheLightOfALamp) {
  // One bin shines. In the world its light is within four pixels or so, and their sum is what it was.
  PolarMap map = PolarMap::make(kGrid, 1);
  const std::size_t lamp = 40 * 360 + 100;
  map.radiance[lamp] = 1000;
  const double expected = 1000.0 * static_cast<double>(map.solid_angle_sr[lamp]);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  WorldPicture world(kGrid, kAll);
  double sum = 0;
  constexpr int kTurns = 60;
  for (int i = 0; i < kTurns; ++i) {
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized();
    LatLongImage picture;
    world.paint(map, turn, picture);
    for (int y = 0; y < 180; ++y)
      for (int x = 0; x < 360; ++x)
        if (const Rgb& pixel = picture.at(x, y); !std::isnan(pixel.x()))
          sum += static_cast<double>(pixel.x()) * picture.pixel_solid_angle_sr(y) / expected;
  }
  // A pixel's mean is over the pieces that fall into it: four of them, give or take two, so that one turn may be off by
  // 40 %, and the mean of 60 by 5 %.
  EXPECT_NEAR(sum / kTurns, 1, 0.15);
}

}  // namespace
}  // namespace lightwell
