// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/picture_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lighting/direction.h"
#include "lighting/lat_long_image.h"
#include "lighting/orientation.h"

namespace lightwell {
namespace {

const PolarGrid kSphere{90, 180, kPi};

// A circle of 186 degrees that the picture holds, turned away from the zenith.
Lens tilted_lens() {
  Lens lens;
  lens.image_size = {121, 131};
  lens.focal = {34, 34.2};
  lens.center = {59.2, 66.7};
  lens.k = {-0.03, 0.004, -0.001, 0.0001};
  lens.max_theta_rad = 93 * kPi / 180;
  lens.zenith = Vec3d(0.2, -0.9, 0.4).normalized();
  return lens;
}

RadiancePicture picture_of(const Lens& lens, float value) {
  RadiancePicture p{lens.image_size[0], lens.image_size[1], {}, {}};
  p.rgb.assign(3 * static_cast<std::size_t>(p.width) * static_cast<std::size_t>(p.height), value);
  return p;
}

// Five decades, every pixel another.
RadiancePicture noise(const Lens& lens) {
  RadiancePicture p = picture_of(lens, 0);
  std::mt19937 random(4);
  std::uniform_real_distribution<float> exponent(-2, 3);
  for (float& v : p.rgb) v = std::pow(10.0F, exponent(random));
  return p;
}

Rgbd sum_of_pixels(const RadiancePicture& p, const Lens& lens, const FlatField& flat) {
  Rgbd sum = Rgbd::Zero();
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x) {
      const double omega = lens.pixel_solid_angle_sr(Vec2d(x, y));
      if (!(omega > 0)) continue;
      const double t = flat.transmission(std::min(lens.theta_rad(Vec2d(x, y)), lens.max_theta_rad));
      for (int c = 0; c < 3; ++c)
        sum[c] += omega / t * static_cast<double>(p.rgb[static_cast<std::size_t>(3 * (y * p.width + x) + c)]);
    }
  return sum;
}

void expect_equal(const Rgbd& a, const Rgbd& b, double relative) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c] / b[c], 1, relative) << c;
}

Rgbd sum_of_image(const LatLongImage& image) {
  Rgbd sum = Rgbd::Zero();
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      sum += image.pixel_solid_angle_sr(y) * image.at(x, y).cast<double>();
  return sum;
}

TEST(PictureMap, NoLightIsLostOrInvented) {
  const Lens lens = tilted_lens();
  const RadiancePicture picture = noise(lens);
  const auto map = polar_map_from_picture(picture, lens, {}, kSphere);
  ASSERT_TRUE(map) << map.error().message;
  const Rgbd truth = sum_of_pixels(picture, lens, {});
  // Every pixel is another and bins hold one or two: each errs by its own half percent, thousands together by 1e-3.
  expect_equal(total_illuminance(*map), truth, 1e-3);
  expect_equal(sum_of_image(lat_long_of_measured(*map)), total_illuminance(*map), 1e-6);  // of float storage
  EXPECT_NEAR(static_cast<double>(map->coverage), (1 - std::cos(lens.max_theta_rad)) / 2, 1e-6);
}

TEST(PictureMap, VignettingIsTakenOut) {
  const Lens lens = tilted_lens();
  FlatField flat;
  flat.vignetting = {0.0666, -0.0761, 0};
  const RadiancePicture picture = noise(lens);
  const auto map = polar_map_from_picture(picture, lens, flat, kSphere);
  ASSERT_TRUE(map) << map.error().message;
  // Across a pixel of 1.7 degrees at the edge transmission changes by 2 %, evenly; what is not even of it is 1e-4.
  expect_equal(total_illuminance(*map), sum_of_pixels(picture, lens, flat), 3e-4);
  EXPECT_GT(total_illuminance(*map)[0], 1.05 * sum_of_pixels(picture, lens, {})[0]);
}

TEST(PictureMap, BinsInsideTheFieldHaveTheirOwnSolidAngleAndOthersNone) {
  const Lens lens = tilted_lens();
  const auto map = polar_map_from_picture(picture_of(lens, 7), lens, {}, kSphere);
  ASSERT_TRUE(map) << map.error().message;
  const Eigen::Matrix3d camera_from_world = world_from_camera_rotation(lens.zenith).transpose();
  for (int ring = 0; ring < kSphere.rings; ++ring)
    for (int sector = 0; sector < kSphere.sectors; ++sector) {
      const Vec3d d = camera_from_world * kSphere.bin_direction(ring, sector);
      const double theta = std::atan2(d.head<2>().norm(), d.z());
      const auto bin = static_cast<std::size_t>(ring * kSphere.sectors + sector);
      const double part = static_cast<double>(map->solid_angle_sr[bin]) / kSphere.bin_solid_angle_sr(ring);
      if (theta < lens.max_theta_rad - 0.04) {
        EXPECT_NEAR(part, 1, 1e-6) << ring << " " << sector;  // of float storage
        EXPECT_NEAR(map->radiance[bin], 7, 1e-5);
      }
      if (theta > lens.max_theta_rad + 0.04) {
        EXPECT_EQ(part, 0) << ring << " " << sector;
        EXPECT_EQ(map->radiance[bin], 0);
      }
    }
}

TEST(PictureMap, AnEvenSkyIsAnEvenImage) {
  Lens lens = tilted_lens();
  lens.image_size = {100, 131};  // which cuts the circle
  const auto map = polar_map_from_picture(picture_of(lens, 7), lens, {}, kSphere);
  ASSERT_TRUE(map) << map.error().message;
  const LatLongImage image = lat_long_of_measured(*map);
  const Eigen::Matrix3d camera_from_world = world_from_camera_rotation(lens.zenith).transpose();
  int inside = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Vec3d d =
          camera_from_world * direction_from_lat_long((x + 0.5) / image.width, (y + 0.5) / image.height);
      // A bin and a half of the border, of two degrees at the most, or of its two pixels.
      if (std::atan2(d.head<2>().norm(), d.z()) > lens.max_theta_rad - 0.05) continue;
      if (lens.project(d).x() > lens.image_size[0] - 0.5 - 2) continue;
      ++inside;
      EXPECT_NEAR(image.at(x, y)[1], 7, 7e-6) << x << " " << y;  // of float storage
    }
  EXPECT_GT(inside, image.width * image.height / 4);
}

TEST(PictureMap, ALampHasItsLightWhereverItIs) {
  const Lens lens = tilted_lens();
  double worst = 0, sum = 0;
  int lamps = 0;
  for (int y = 30; y < 110; y += 13)
    for (int x = 35; x < 90; x += 17, ++lamps) {
      RadiancePicture picture = picture_of(lens, 0);
      picture.rgb[static_cast<std::size_t>(3 * (y * picture.width + x) + 1)] = 1e5F;
      const auto map = polar_map_from_picture(picture, lens, {}, {30, 60, kPi});
      ASSERT_TRUE(map) << map.error().message;
      const double error = total_illuminance(*map)[1] / (1e5 * lens.pixel_solid_angle_sr(Vec2d(x, y))) - 1;
      worst = std::max(worst, std::abs(error));
      sum += error;
    }
  // Bins of some twelve pixels have their area in parts to half a percent; the worst of dozens errs by four times that.
  EXPECT_LT(worst, 0.02);
  EXPECT_NEAR(sum / lamps, 0, 4e-3);
}

TEST(PictureMap, AFieldSmallerThanAPixelIsWhereItLooks) {
  Lens lens = tilted_lens();
  lens.center = {59, 66};  // a pixel's centre is on the axis
  lens.max_theta_rad = 1e-3;
  const auto map = polar_map_from_picture(picture_of(lens, 7), lens, {}, kSphere);
  ASSERT_TRUE(map) << map.error().message;
  const double seen = 2 * kPi * (1 - std::cos(1e-3));
  double sum = 0;
  for (std::size_t bin = 0; bin < kSphere.size(); ++bin) {
    ASSERT_TRUE(std::isfinite(map->plane(1)[bin]));
    sum += static_cast<double>(map->plane(1)[bin] * map->solid_angle_sr[bin]);
  }
  // The rim of a circle in a pixel is integrated by lines: what pixel_solid_angle_sr promises is absolute.
  EXPECT_NEAR(sum / 7, seen, 1e-6 * lens.pixel_solid_angle_sr(lens.center) + 1e-6);
}

TEST(PictureMap, ALampIsWhereTheLensSaysIt) {
  const Lens lens = tilted_lens();
  const Eigen::Matrix3d world_from_camera = world_from_camera_rotation(lens.zenith);
  for (const auto& [x, y] : {std::pair(59, 66), std::pair(20, 90), std::pair(95, 40), std::pair(61, 115)}) {
    RadiancePicture picture = picture_of(lens, 0);
    picture.rgb[static_cast<std::size_t>(3 * (y * picture.width + x) + 1)] = 1e5F;
    const auto map = polar_map_from_picture(picture, lens, {}, kSphere);
    ASSERT_TRUE(map) << map.error().message;
    Vec3d mean = Vec3d::Zero();
    for (int ring = 0; ring < kSphere.rings; ++ring)
      for (int sector = 0; sector < kSphere.sectors; ++sector) {
        const auto bin = static_cast<std::size_t>(ring * kSphere.sectors + sector);
        mean += static_cast<double>(map->plane(1)[bin] * map->solid_angle_sr[bin]) *
                kSphere.bin_direction(ring, sector);
      }
    const Vec3d truth = world_from_camera * lens.unproject(Vec2d(x, y));
    // A pixel of some 1.7 degrees in bins of 2: where it lies in one, its middle is off by up to 0.15 along each side.
    EXPECT_LT(std::acos(std::min(1.0, mean.normalized().dot(truth))) * 180 / kPi, 0.3) << x << " " << y;
  }
}

TEST(PictureMap, AShrunkLensSeesTheMiddleOfEachSquare) {
  const Lens lens = tilted_lens();
  const Lens small = shrunk(lens, 4);
  EXPECT_EQ(small.image_size, (std::array<int, 2>{31, 33}));
  for (const Vec2d& at : {Vec2d(3, 7), Vec2d(20, 11)})
    EXPECT_LT((small.unproject(at) - lens.unproject(4 * at + Vec2d(1.5, 1.5))).norm(), 1e-12);
}

TEST(PictureMap, ClippedPixelsAreCountedWhereTheyAre) {
  const Lens lens = tilted_lens();
  RadiancePicture picture = picture_of(lens, 1);
  picture.clipped.assign(picture.rgb.size() / 3, 0);
  picture.clipped[static_cast<std::size_t>(60 * picture.width + 60)] = 1;
  picture.clipped[0] = 1;  // beyond the circle
  const auto map = polar_map_from_picture(picture, lens, {}, kSphere);
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(map->clipped_pixels, 1U);
}

TEST(PictureMap, APictureOfAnotherSizeIsRefused) {
  const Lens lens = tilted_lens();
  RadiancePicture picture = picture_of(lens, 1);
  --picture.height;
  const auto map = polar_map_from_picture(picture, lens, {}, kSphere);
  ASSERT_FALSE(map);
  EXPECT_THAT(map.error().message, testing::HasSubstr("lens.image_size[1] = 131: allowed 130"));
}

}  // namespace
}  // namespace lightwell
