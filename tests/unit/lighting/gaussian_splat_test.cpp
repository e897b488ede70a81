// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/gaussian_splat.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

namespace lightwell {
namespace {

constexpr int kSide = 9;
const FieldGrid kGrid{{kSide, kSide, kSide}, Vec3d::Zero(), Vec3d::Constant(kSide - 1)};

struct Rays {
  std::vector<Vec3d> through;
  std::vector<Eigen::Array3f> radiance;
};

Rays random_rays(int count) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(0, kSide - 1);
  std::uniform_real_distribution<float> light(0, 5);
  Rays rays;
  for (int i = 0; i < count; ++i) {
    rays.through.emplace_back(place(random), place(random), place(random));
    rays.radiance.emplace_back(light(random), light(random), 1.0f);
  }
  return rays;
}

// The paper's own: every ray through the volume, every grid point within the kernel. NaN where none is.
Eigen::Array3d splat_in_space(const Rays& rays, const Vec3d& direction, const Vec3d& point) {
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  double weights = 0;
  for (std::size_t i = 0; i < rays.through.size(); ++i) {
    const double distance = (point - rays.through[i]).cross(direction.normalized()).norm();
    if (distance > kNearCells) continue;
    const double weight = std::exp(-0.5 * std::pow(distance / kSplatSigmaCells, 2));
    sum += weight * rays.radiance[i].cast<double>();
    weights += weight;
  }
  return sum / weights;
}

PlaneImage splat_in_plane(const Rays& rays, const ShearPlane& plane) {
  std::vector<PlaneSample> samples;
  for (std::size_t i = 0; i < rays.through.size(); ++i)
    samples.push_back({plane.across(plane.pixel_of(rays.through[i])).cast<float>(), rays.radiance[i]});
  PlaneImage image;
  gaussian_splat(plane, samples, image);
  return image;
}

// Along axes and diagonals grid points lie on the plane's pixels: the two are one, to float rounding.
TEST(GaussianSplat, InThePlaneIsTheSplatInSpace) {
  const Rays rays = random_rays(60);
  int compared = 0, holes = 0;
  for (const Vec3d& direction : {Vec3d(1, 0, 0), Vec3d(0, -1, 0), Vec3d(0, 0, 1), Vec3d(1, 1, 0),
                                 Vec3d(1, 0, -1), Vec3d(-1, 1, 1), Vec3d(1, 1, 1)}) {
    const ShearPlane plane(kGrid, direction, 1);
    const PlaneImage image = splat_in_plane(rays, plane);
    for (int k = 0; k < kSide; ++k)
      for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i) {
          const Vec3d point(i, j, k);
          const Vec2d pixel = plane.pixel_of(point);
          const int x = static_cast<int>(std::lround(pixel.x())),
                    y = static_cast<int>(std::lround(pixel.y()));
          ASSERT_LT((pixel - Vec2d(x, y)).norm(), 1e-9);
          const auto at = static_cast<std::size_t>(y * image.width + x);
          const Eigen::Array3d expected = splat_in_space(rays, direction, point);
          const bool known = std::isfinite(expected[0]);
          EXPECT_EQ(image.channel(3)[at], known ? 1 : 0);
          ++(known ? compared : holes);
          if (!known) continue;
          for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(static_cast<double>(image.channel(c)[at]), expected[c], 1e-4);
        }
  }
  EXPECT_GT(compared, 1000);
  EXPECT_GT(holes, 100);
}

TEST(GaussianSplat, RepairFillsEveryHoleWithLightFromAround) {
  const Rays rays = random_rays(5);
  const ShearPlane plane(kGrid, Vec3d(0.2, 0.3, 1), 2);
  const PlaneImage image = splat_in_plane(rays, plane);
  int holes = 0;
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    holes += image.channel(3)[i] == 0;
    EXPECT_NEAR(image.channel(2)[i], 1, 1e-5f);  // where all rays agree, so do all pixels
    EXPECT_GE(image.channel(0)[i], 0);
    EXPECT_LE(image.channel(0)[i], 5);
  }
  EXPECT_GT(holes, 50);
}

TEST(GaussianSplat, OfNoRaysIsDark) {
  const ShearPlane plane(kGrid, Vec3d(0.2, 0.3, 1), 2);
  PlaneImage image;
  gaussian_splat(plane, {}, image);
  for (const float value : image.channels) EXPECT_EQ(value, 0);
}

}  // namespace
}  // namespace lightwell
