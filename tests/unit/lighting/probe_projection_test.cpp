// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/probe_projection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lighting/direction.h"

namespace lightwell {
namespace {

TEST(ProbeProjection, LatLongIsTheConvention) {
  const auto ray = ray_of(LatLongProbe{}, 64, 32, 16, 16);
  ASSERT_TRUE(ray);
  EXPECT_LT((ray->direction - Vec3d::UnitX()).norm(), 1e-12);  // the left half looks along +X
}

TEST(ProbeProjection, MirrorBallReflectsTheCamerasRays) {
  const MirrorBallProbe ball{0.05, std::nullopt, 0};
  for (const double x : {12.0, 50.0, 81.3})
    for (const double y : {20.0, 50.0, 77.7}) {
      const auto ray = ray_of(ball, 100, 100, x, y);
      ASSERT_TRUE(ray);
      EXPECT_NEAR(ray->origin.norm(), 0.05, 1e-12);  // on the ball
      EXPECT_NEAR(ray->origin.x(), 0.05 * (x - 50) / 50, 1e-12);
      EXPECT_NEAR(ray->origin.y(), 0.05 * (50 - y) / 50, 1e-12);
      // Angle in is angle out, in one plane: the normal halves the way to the camera and that to the light.
      const Vec3d half = (ray->direction + Vec3d::UnitZ()).normalized();
      EXPECT_LT((half - ray->origin.normalized()).norm(), 1e-12);
    }
  EXPECT_LT((ray_of(ball, 100, 100, 50, 50)->direction - Vec3d::UnitZ()).norm(), 1e-12);
  EXPECT_GT(ray_of(ball, 100, 100, 80, 50)->direction.x(), 0.5);
  EXPECT_FALSE(ray_of(ball, 100, 100, 1, 1));  // beside the ball
}

TEST(ProbeProjection, MirrorBallSeenFromNearReflectsAtItsSurface) {
  const double distance = 0.3;
  const MirrorBallProbe ball{0.05, distance, 0};
  const Vec3d camera(0, 0, distance);
  for (const double x : {12.0, 50.0, 88.0})
    for (const double y : {30.0, 50.0, 77.7}) {
      const auto ray = ray_of(ball, 100, 100, x, y);
      ASSERT_TRUE(ray);
      EXPECT_NEAR(ray->origin.norm(), 0.05, 1e-12);
      const Vec3d to_camera = (camera - ray->origin).normalized();
      EXPECT_LT((to_camera + ray->direction).normalized().dot(ray->origin.normalized()) * -1 + 1, 1e-12);
      // It lies where the camera's ray through that place of the picture goes: the rim is the tangent of asin(r / d).
      const Vec3d seen = ray->origin - camera;
      const double rim = std::tan(std::asin(0.05 / distance));
      EXPECT_NEAR(seen.x() / -seen.z(), (x - 50) / 50 * rim, 1e-12);
      EXPECT_NEAR(seen.y() / -seen.z(), (50 - y) / 50 * rim, 1e-12);
    }
  EXPECT_NEAR(blind_cone_rad(ball), std::asin(0.05 / distance), 1e-15);  // what stands behind the ball
  // From far away it is the parallel view.
  const auto far = ray_of(MirrorBallProbe{0.05, 1e5, 0}, 100, 100, 80, 33);
  const auto parallel = ray_of(MirrorBallProbe{0.05, std::nullopt, 0}, 100, 100, 80, 33);
  EXPECT_LT((far->direction - parallel->direction).norm(), 1e-5);
}

TEST(ProbeProjection, MirrorBallHasABlindCone) {
  const MirrorBallProbe ball{0, std::nullopt, 10 * kPi / 180};
  // θ from +Z is 2 asin(ρ): 170° at ρ = sin 85°.
  const double rho = std::sin(85 * kPi / 180);
  EXPECT_TRUE(ray_of(ball, 2, 2, 1 + rho - 1e-6, 1));
  EXPECT_FALSE(ray_of(ball, 2, 2, 1 + rho + 1e-6, 1));
}

TEST(ProbeProjection, FisheyeLooksThroughItsLens) {
  Lens lens;
  lens.image_size = {200, 200};
  lens.focal = {60, 60};
  lens.center = {99.5, 99.5};
  const auto up = ray_of(FisheyeProbe{lens}, 200, 200, 100, 100);
  ASSERT_TRUE(up);
  EXPECT_LT((up->direction - Vec3d::UnitY()).norm(), 1e-12);
  const auto right = ray_of(FisheyeProbe{lens}, 200, 200, 100 + 60, 100);  // one radian off the zenith
  ASSERT_TRUE(right);
  EXPECT_LT((right->direction - direction_from_spherical({1, kPi / 2})).norm(), 1e-12);
  EXPECT_FALSE(ray_of(FisheyeProbe{lens}, 200, 200, 100 + 95, 100));  // beyond 90°
}

}  // namespace
}  // namespace lightwell
