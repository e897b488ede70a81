// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/simulator/projector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lighting/direction.h"
#include "lighting/orientation.h"
#include "tests/support/simulated_frames.h"

namespace lightwell::simulator {
namespace {

using test::black_image;

double plane_sum(const Projector& projector, std::span<const float> plane) {
  double sum = 0;
  for (std::size_t i = 0; i < plane.size(); ++i)
    sum += static_cast<double>(plane[i]) * static_cast<double>(projector.solid_angles()[i]);
  return sum;
}

TEST(Projector, ARayKeepsItsEnergyAtPoleHorizonSeamAndAnywhere) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const auto& [width, height] : {std::pair(64, 48), {33, 47}, {1, 1}, {2, 3}}) {
    const Projector projector(default_lens(width, height), false);
    std::vector<Spherical> where = {
        {0, 0}, {kPi / 2 - 1e-9, 0}, {kPi / 2 - 1e-9, kPi}, {1, 1e-12}, {1, 2 * kPi - 1e-12}};
    for (int i = 0; i < 500; ++i) where.push_back({kPi / 2 * unit(random), 2 * kPi * unit(random)});
    for (const Spherical& s : where) {
      std::vector<float> plane(projector.pixels(), 0.0f);
      projector.add_ray(direction_from_spherical(s), Rgbd::Constant(1000), plane);
      // Floats: up to four additions, each rounded to 6e-8.
      EXPECT_NEAR(plane_sum(projector, plane), 1000, 1000 * 1e-6)
          << s.theta_rad << " " << s.lambda_rad << " " << width;
    }
  }
}

TEST(Projector, ARayStaysWithinAPixelOfItsImage) {
  const Projector projector(default_lens(64, 48), false);
  const Vec3d direction = direction_from_spherical({0.7, 2.1});
  const Vec2d at = projector.lens().project(camera_from_world(direction));
  std::vector<float> plane(projector.pixels(), 0.0f);
  projector.add_ray(direction, Rgbd::Constant(1), plane);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x)
      if (std::abs(x - at.x()) >= 1 || std::abs(y - at.y()) >= 1) {
        EXPECT_EQ(plane[static_cast<std::size_t>(y * 64 + x)], 0.0f);
      }
}

TEST(Projector, EveryBayerSiteGetsTheWholeOfItsChannel) {
  const Projector projector(default_lens(64, 48), true);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 200; ++i) {
    std::vector<float> plane(projector.pixels(), 0.0f);
    projector.add_ray(direction_from_spherical({1.5 * unit(random), 6 * unit(random)}), Rgbd(10, 20, 30),
                      plane);
    double site[4] = {};
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x) {
        const auto k = static_cast<std::size_t>(y * 64 + x);
        site[(y & 1) * 2 + (x & 1)] +=
            4 * static_cast<double>(plane[k]) * static_cast<double>(projector.solid_angles()[k]);
      }
    EXPECT_NEAR(site[0], 10, 1e-4);
    EXPECT_NEAR(site[1], 20, 2e-4);
    EXPECT_NEAR(site[2], 20, 2e-4);
    EXPECT_NEAR(site[3], 30, 3e-4);
  }
}

TEST(Projector, AnEvenSkyIsEvenAndExactInSum) {
  LatLongImage sky = black_image(100, 50);
  for (Rgb& p : sky.pixels) p = Rgb::Constant(5);
  const Projector projector(default_lens(320, 240), false);
  for (const bool smooth : {true, false}) {
    const std::vector<float> plane = projector.project({sky, smooth});
    EXPECT_NEAR(plane_sum(projector, plane), 5 * 2 * kPi, 5 * 2 * kPi * 1e-5)
        << smooth;  // float sums of 5e4 values
    const Vec2d center = projector.lens().center;
    for (int y = 0; y < 240; ++y)
      for (int x = 0; x < 320; ++x)
        if ((Vec2d(x, y) - center).norm() < 114) {  // rays near the border are kept inside, which is
          // not even; elsewhere rays closer than pixels leave a pattern of 1 %
          EXPECT_NEAR(plane[static_cast<std::size_t>(y * 320 + x)], 5, 5 * 0.01)
              << smooth << " " << x << " " << y;
        }
  }
}

TEST(Projector, OneBurningPixelKeepsItsEnergyWhereverItIs) {
  for (const bool bayer : {false, true}) {
    const Projector projector(default_lens(160, 120), bayer);
    for (const auto& [x, y] : {std::pair(0, 0), {511, 10}, {256, 127}, {0, 127}, {100, 64}, {300, 90}}) {
      LatLongImage image = black_image(512, 256);
      image.at(x, y) = Rgb::Constant(1e8f);
      const double energy = hemisphere_illuminance(image)[0];
      EXPECT_NEAR(energy, 1e8 * image.pixel_solid_angle_sr(y), energy * 1e-9);
      const std::vector<float> plane = projector.project({image, false});
      EXPECT_NEAR(plane_sum(projector, plane), energy, energy * (bayer ? 2e-2 : 1e-5))
          << x << " " << y;  // Bayer sites stand for four pixels, whose solid angles differ across a quad
    }
  }
}

TEST(Projector, AnImageOfOneRowCoversTheHemisphereExactly) {
  LatLongImage image = black_image(3, 1);
  for (Rgb& p : image.pixels) p = Rgb::Constant(2);
  EXPECT_NEAR(hemisphere_illuminance(image)[1], 4 * kPi, 1e-9);
  const Projector projector(default_lens(31, 17), false);
  EXPECT_NEAR(plane_sum(projector, projector.project({image, false})), 4 * kPi, 4 * kPi * 1e-5);
}

Lens tilted_lens(int size) {
  Lens lens = default_lens(size, size);
  lens.zenith = Vec3d(0.2, -0.3, 0.9).normalized();
  return lens;
}

TEST(Projector, ATiltedCameraSeesARayWhereItsLensHasIt) {
  const Projector projector(tilted_lens(64), false);
  const Lens& lens = projector.lens();
  // Straight up lies at the zenith's own image, the axis of the camera where the world has it.
  for (const auto& [direction, at] :
       {std::pair(Vec3d(Vec3d::UnitY()), lens.project(lens.zenith)),
        std::pair(Vec3d(world_from_camera_rotation(lens.zenith) * Vec3d::UnitZ()), lens.center)}) {
    std::vector<float> plane(projector.pixels(), 0.0f);
    projector.add_ray(direction, Rgbd::Constant(1000), plane);
    EXPECT_NEAR(plane_sum(projector, plane), 1000, 1000 * 1e-6);  // float sums of four
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x)
        if (std::abs(x - at.x()) >= 1 || std::abs(y - at.y()) >= 1) {
          EXPECT_EQ(plane[static_cast<std::size_t>(y * 64 + x)], 0.0f) << x << " " << y;
        }
  }
}

TEST(Projector, ATiltedCameraSeesAnEvenSphereEvenlyAndABurningPixelWhole) {
  const Projector projector(tilted_lens(200), false);
  LatLongImage sphere = black_image(100, 50);
  for (Rgb& p : sphere.pixels) p = Rgb::Constant(5);
  for (const bool smooth : {true, false}) {
    const std::vector<float> plane = projector.project({sphere, smooth});
    // Interpolated it is the sky itself; rays leave a pattern of 1 % an axis (projector.cpp), and here the pixels' axes
    // lie across both of theirs.
    const double tolerance = smooth ? 1e-6 : 0.02;
    for (int y = 0; y < 200; ++y)
      for (int x = 0; x < 200; ++x)
        if ((Vec2d(x, y) - projector.lens().center).norm() < 94) {
          EXPECT_NEAR(plane[static_cast<std::size_t>(y * 200 + x)], 5, 5 * tolerance) << smooth;
        }
  }
  for (const auto& [x, y] : {std::pair(0, 0), {511, 10}, {256, 100}, {100, 64}}) {
    LatLongImage image = black_image(512, 256);
    image.at(x, y) = Rgb::Constant(1e8f);
    const double energy = 1e8 * image.pixel_solid_angle_sr(y);
    const std::vector<float> plane = projector.project({image, false});
    EXPECT_NEAR(plane_sum(projector, plane), energy, energy * 1e-5) << x << " " << y;  // float sums
  }
}

}  // namespace
}  // namespace lightwell::simulator
