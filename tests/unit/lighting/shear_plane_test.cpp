// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/shear_plane.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

namespace lightwell {
namespace {

const FieldGrid kGrid{{5, 7, 4}, Vec3d(-1, 0, 2), Vec3d(1, 3, 3)};

Vec3d random_vector(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return {normal(random), normal(random), normal(random)};
}

TEST(ShearPlane, DistancesAcrossAreDistancesOfRays) {
  std::mt19937 random(1);
  for (int i = 0; i < 100; ++i) {
    const Vec3d direction = random_vector(random);
    const ShearPlane plane(kGrid, direction, 1 + i % 3);
    const Vec3d a = random_vector(random), b = random_vector(random);
    const Vec3d d = direction.cwiseQuotient(kGrid.cell()).normalized();
    const double distance = (a - b).cross(d).norm();  // of two parallel lines, in cells
    EXPECT_NEAR((plane.across(plane.pixel_of(a)) - plane.across(plane.pixel_of(b))).norm(), distance, 1e-12);
  }
}

TEST(ShearPlane, APlaceAlongTheRayIsTheSamePixel) {
  std::mt19937 random(2);
  for (int i = 0; i < 100; ++i) {
    const Vec3d direction = random_vector(random), at = random_vector(random);
    const ShearPlane plane(kGrid, direction, 2);
    const Vec2d here = plane.pixel_of(kGrid.grid_from_world(at));
    const Vec2d there = plane.pixel_of(kGrid.grid_from_world(at + 1.7 * direction));
    EXPECT_LT((here - there).norm(), 1e-11 * (1 + here.norm()));
  }
}

TEST(ShearPlane, CoversEveryGridPointWithAPixelBeyond) {
  std::mt19937 random(3);
  for (int i = 0; i < 100; ++i) {
    const ShearPlane plane(kGrid, i < 3 ? Vec3d(Vec3d::Unit(i)) : random_vector(random), 1 + i % 3);
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3d at((corner & 1) * (kGrid.size[0] - 1), (corner >> 1 & 1) * (kGrid.size[1] - 1),
                     (corner >> 2) * (kGrid.size[2] - 1));
      const Vec2d pixel = plane.pixel_of(at);
      EXPECT_GT(pixel.minCoeff(), -1e-9);
      EXPECT_LT(pixel.x(), plane.width() - 1 + 1e-9);
      EXPECT_LT(pixel.y(), plane.height() - 1 + 1e-9);
      const Vec2d in_slice = pixel - plane.slice_origin(static_cast<int>(at[plane.axes()[2]]));
      EXPECT_NEAR(in_slice.x(), plane.pixels_a_cell() * at[plane.axes()[0]], 1e-9);
      EXPECT_NEAR(in_slice.y(), plane.pixels_a_cell() * at[plane.axes()[1]], 1e-9);
    }
  }
}

}  // namespace
}  // namespace lightwell
