// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/lat_long_image.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <tuple>

namespace lightwell {
namespace {

LatLongImage random_image(int width, int height, unsigned seed) {
  LatLongImage image{width, height, {}};
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> value(0.0f, 1.0f);
  for (int i = 0; i < width * height; ++i) {
    const float r = value(generator), g = value(generator), b = value(generator);
    image.pixels.emplace_back(r, g * g, b * b * b);
  }
  return image;
}

// Pixel by pixel from the convention: θ = πv, direction from the pixel's centre, its share above the horizon.
Rgbd total_by_pixels(const LatLongImage& image, bool hemisphere) {
  Rgbd total = Rgbd::Zero();
  for (int y = 0; y < image.height; ++y) {
    double top = std::cos(kPi * y / image.height);
    double bottom = std::cos(kPi * (y + 1) / image.height);
    if (hemisphere) {
      top = std::max(top, 0.0);
      bottom = std::max(bottom, 0.0);
    }
    for (int x = 0; x < image.width; ++x)
      total += image.at(x, y).cast<double>() * ((top - bottom) * 2 * kPi / image.width);
  }
  return total;
}

// Solid angles are stored as floats and radiance is: their products carry a few 2^-24 each.
constexpr double kFloatRounding = 3e-7;

double relative(const Rgbd& a, const Rgbd& b) {
  return (a - b).abs().maxCoeff() / b.abs().maxCoeff();
}

TEST(LatLongImage, PixelSolidAnglesSumToTheSphere) {
  for (const int height : {1, 2, 7, 512}) {
    const LatLongImage image{5, height, {}};
    double sum = 0;
    for (int y = 0; y < height; ++y) sum += 5 * image.pixel_solid_angle_sr(y);
    EXPECT_NEAR(sum, 4 * kPi, 1e-12);  // double rounding of 512 terms
  }
}

TEST(PolarMapFromLatLong, KeepsEveryPixelsEnergyForAnySizeAndTurn) {
  for (const auto& [w, h] : {std::pair{1, 1}, {2, 1}, {1, 2}, {3, 3}, {5, 4}, {8, 5}, {64, 32}, {63, 31}})
    for (const bool hemisphere : {false, true})
      for (const double turn : {0.0, 0.3, -2.0, 7.0}) {
        const LatLongImage image = random_image(w, h, 7);
        const PolarMap map = polar_map_from_lat_long(image, hemisphere, turn);
        EXPECT_LT(relative(total_illuminance(map), total_by_pixels(image, hemisphere)), kFloatRounding)
            << w << "x" << h << " " << hemisphere << " " << turn;
        EXPECT_DOUBLE_EQ(map.grid.theta_max_rad, hemisphere ? kPi / 2 : kPi);
        EXPECT_NEAR(map.coverage, hemisphere ? 0.5f : 1.0f, 1e-7f);
      }
}

TEST(PolarMapFromLatLong, BinsLieWhereTheConventionPutsThePixels) {
  for (const auto& [w, h] : {std::pair{8, 4}, {7, 3}, {6, 5}, {1, 1}}) {
    const LatLongImage image = random_image(w, h, 3);
    for (const bool hemisphere : {false, true}) {
      const PolarMap map = polar_map_from_lat_long(image, hemisphere);
      for (int ring = 0; ring < map.grid.rings; ++ring)
        for (int sector = 0; sector < map.grid.sectors; ++sector) {
          const Vec2d uv = lat_long_from_direction(map.grid.bin_direction(ring, sector));
          const Rgb expected = image.at(static_cast<int>(uv.x() * w), static_cast<int>(uv.y() * h));
          const auto bin = static_cast<std::size_t>(ring * map.grid.sectors + sector);
          EXPECT_TRUE((map.rgb(bin) == expected).all()) << w << "x" << h << " " << ring << " " << sector;
        }
    }
  }
}

TEST(PolarMapFromLatLong, TurnMovesALightTowardGreaterAzimuth) {
  LatLongImage image{360, 180, std::vector<Rgb>(360 * 180, Rgb::Zero())};
  const Vec2d uv = lat_long_from_direction(direction_from_spherical({1.0, 0.5 * kPi / 180}));
  image.at(static_cast<int>(uv.x() * 360), static_cast<int>(uv.y() * 180)) = Rgb::Constant(1);
  for (const int degrees : {0, 1, 90, 200, -30}) {
    const PolarMap map = polar_map_from_lat_long(image, false, degrees * kPi / 180);
    const auto bin = static_cast<std::size_t>(57 * 360 + ((degrees % 360 + 360) % 360));
    EXPECT_EQ(map.rgb(bin)[0], 1.0f) << degrees;  // whole columns move exactly
  }
  const PolarMap half = polar_map_from_lat_long(image, false, 10.25 * kPi / 180);
  EXPECT_NEAR(half.rgb(57 * 360 + 10)[0], 0.75f, 1e-6f);  // float rounding of the blend
  EXPECT_NEAR(half.rgb(57 * 360 + 11)[0], 0.25f, 1e-6f);
}

TEST(ResamplePolar, KeepsTheEnergyOnAnyGridThatCoversTheMap) {
  for (const auto& [w, h] : {std::pair{64, 32}, {17, 9}, {1, 1}}) {
    const PolarMap map = polar_map_from_lat_long(random_image(w, h, 11), true);
    for (const PolarGrid grid : {PolarGrid{90, 360, kPi / 2}, PolarGrid{7, 5, kPi / 2},
                                 PolarGrid{1, 1, kPi / 2}, PolarGrid{50, 33, 2.0}, PolarGrid{90, 45, kPi}}) {
      const PolarMap out = resample_polar(map, grid);
      EXPECT_LT(relative(total_illuminance(out), total_illuminance(map)), kFloatRounding);
      EXPECT_NEAR(out.coverage, 0.5f, 1e-6f);
      for (const float value : out.radiance) EXPECT_TRUE(std::isfinite(value) && value >= 0);
    }
  }
}

TEST(ResamplePolar, OneBurningPixelKeepsItsEnergyAtPoleHorizonAndSeam) {
  for (const auto& [ring, sector] : {std::pair{0, 0}, {31, 5}, {10, 0}, {10, 127}}) {
    PolarMap map = PolarMap::make({32, 128, kPi / 2}, 3);
    const auto bin = static_cast<std::size_t>(ring * 128 + sector);
    map.plane(1)[bin] = 1e8f;
    const PolarMap out = resample_polar(map, {90, 360, kPi / 2});
    EXPECT_LT(relative(total_illuminance(out), total_illuminance(map)), kFloatRounding);
  }
}

TEST(ResamplePolar, AConstantMapStaysConstant) {
  PolarMap map = PolarMap::make({11, 13, kPi / 2}, 1);
  for (float& value : map.radiance) value = 2.5f;
  const PolarMap out = resample_polar(map, {90, 360, kPi});
  for (const float value : out.radiance)
    EXPECT_NEAR(value, 2.5f, 2.5f * 4e-7f);  // float rounding of the quotient
}

TEST(ResamplePolar, TheSameGridGivesTheSameMap) {
  const PolarMap map = polar_map_from_lat_long(random_image(36, 18, 5), true);
  const PolarMap out = resample_polar(map, map.grid);
  for (std::size_t i = 0; i < map.radiance.size(); ++i)
    EXPECT_NEAR(out.radiance[i], map.radiance[i],
                4e-7f * map.radiance[i]);  // float rounding of the solid angles
}

TEST(LatLongFromPolarMap, UndoesPolarMapFromLatLong) {
  const LatLongImage image = random_image(36, 18, 5);
  const LatLongImage back = lat_long_from_polar_map(polar_map_from_lat_long(image, false));
  ASSERT_EQ(back.width, 36);
  ASSERT_EQ(back.height, 18);
  // Its own flux divided by its own solid angle: one rounding.
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    EXPECT_LT((back.pixels[i] - image.pixels[i]).abs().maxCoeff(), 1.2e-7f) << i;
}

TEST(LatLongFromPolarMap, AHemisphereIsBlackBelowAndKeepsItsEnergyAbove) {
  for (const auto& [rings, sectors, theta_max] :
       {std::tuple(90, 360, kPi / 2), {9, 35, kPi / 2}, {1, 1, kPi / 2}, {7, 12, kPi}, {30, 61, kPi}}) {
    PolarMap map = PolarMap::make({rings, sectors, theta_max}, 3);
    std::mt19937 generator(6);
    std::uniform_real_distribution<float> value(0.0f, 5.0f);
    for (float& radiance : map.radiance) radiance = value(generator);
    const LatLongImage image = lat_long_from_polar_map(map);
    Rgbd total = Rgbd::Zero();
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        total += image.at(x, y).cast<double>() * image.pixel_solid_angle_sr(y);
        if ((y + 0.5) / image.height * kPi > theta_max) {
          EXPECT_TRUE((image.at(x, y) == Rgb::Zero()).all());
        }
      }
    EXPECT_LT(relative(total, total_illuminance(map)), kFloatRounding) << rings << " " << sectors;
  }
}

TEST(LatLongFromPolarMap, AnyEdgeAndSizeGivesAPicture) {
  for (const double theta_max : {0.01, 1.0, 1.7, 3.1}) {
    PolarMap map = PolarMap::make({1, 1, theta_max}, 1);
    map.radiance[0] = 1e30f;
    for (const Rgb& pixel : lat_long_from_polar_map(map).pixels) EXPECT_TRUE(pixel.isFinite().all());
  }
}

TEST(ResamplePolar, CountsOfClippedPixelsAreKept) {
  PolarMap map = PolarMap::make({9, 36, kPi / 2}, 1);
  map.clipped[5] = 3;
  map.clipped[200] = 4;
  map.clipped_pixels = 7;
  const PolarMap out = resample_polar(map, {4, 7, kPi / 2});
  unsigned sum = 0;
  for (const auto count : out.clipped) sum += count;
  EXPECT_EQ(sum, 7u);
  EXPECT_EQ(out.clipped_pixels, 7u);
}

}  // namespace
}  // namespace lightwell
