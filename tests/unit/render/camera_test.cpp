// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/camera.h"

#include <gtest/gtest.h>

#include "tests/support/test_scene.h"

namespace lightwell::render {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

Vec3f ndc(const View& view, const Vec3f& p) {
  const Eigen::Vector4f clip = view.clip_from_world * p.homogeneous();
  return clip.head<3>() / clip.w();
}

TEST(Camera, RaysAndProjectionAgreeWithAndWithoutAnOffset) {
  const SceneCamera camera = camera_at({1, 2, 5}, {0.3f, 0.2f, 0});
  for (const Vec2f& offset : {Vec2f(0, 0), Vec2f(0.4f, -0.3f)}) {
    const View view = make_view(camera, 320, 200, offset);
    for (const Vec2f& at : {Vec2f(0, 0), Vec2f(-0.7f, 0.4f), Vec2f(1, 1)}) {
      const Vec3f p = view.eye + 3 * (view.forward + at.x() * view.right + at.y() * view.up);
      EXPECT_LT((ndc(view, p).head<2>() - at).norm(), 1e-5f);
    }
  }
}

TEST(Camera, AnOffsetSeesWhatLiesThereInThePixel) {
  const SceneCamera camera = camera_at({0, 0, 5}, {0, 0, 0});
  const View centre = make_view(camera, 100, 100);
  const View shifted = make_view(camera, 100, 100, {0.5f, 0});
  // Half a pixel to the right is 2 / 100 / 2 of normalised coordinates.
  EXPECT_LT((shifted.forward - (centre.forward + 0.01f * centre.right)).norm(), 1e-6f);
}

TEST(Camera, VerticalFieldAndAspectAreTheFiles) {
  SceneCamera camera = camera_at({0, 0, 1}, {0, 0, 0}, 1.0f);
  const float edge = std::tan(0.5f);
  EXPECT_NEAR(ndc(make_view(camera, 200, 100), {0, edge, 0}).y(), 1, 1e-5f);
  EXPECT_NEAR(ndc(make_view(camera, 200, 100), {2 * edge, 0, 0}).x(), 1, 1e-5f);
  camera.aspect = 1.5f;
  EXPECT_NEAR(ndc(make_view(camera, 200, 100), {1.5f * edge, 0, 0}).x(), 1, 1e-5f);
}

TEST(Camera, FittedCameraSeesEverythingAtAnyAspectFromOneUp) {
  Scene scene;
  add_box(scene, {-3, -1, 7}, {2, 1, 9}, lambertian(Rgb::Ones()));
  const SceneCamera camera = fitted_camera(scene);
  for (const int width : {100, 300}) {
    const View view = make_view(camera, width, 100);
    for (const Vertex& v : scene.vertices) {
      const Vec3f p = ndc(view, v.position);
      EXPECT_LE(p.cwiseAbs().maxCoeff(), 1) << p.transpose();
    }
  }
}

TEST(Orbit, StartsExactlyAtTheCameraAndComesBack) {
  Scene scene;
  add_box(scene, {-1, 0, -1}, {1, 1, 1}, lambertian(Rgb::Ones()));
  const SceneCamera start = camera_at({2, 3, 4}, {0, 0.5f, 0});
  Orbit orbit(start, scene);
  EXPECT_EQ(orbit.camera().world_from_camera, start.world_from_camera);
  orbit.turn(0.5f, -0.2f);
  EXPECT_GT((orbit.camera().world_from_camera - start.world_from_camera).norm(), 0.1f);
  orbit.turn(-0.5f, 0.2f);
  EXPECT_LT((orbit.camera().world_from_camera - start.world_from_camera).norm(), 1e-5f);
}

TEST(Orbit, SlidingMovesEyeAndTargetAcrossTheView) {
  Scene scene;
  add_box(scene, {-1, -1, -1}, {1, 1, 1}, lambertian(Rgb::Ones()));
  Orbit orbit(camera_at({0, 0, 4}, {0, 0, 0}), scene);
  orbit.slide(0.5f, -0.25f);  // of the distance, 4 m
  const auto eye = [&] { return Vec3f(orbit.camera().world_from_camera.col(3).head<3>()); };
  EXPECT_LT((eye() - Vec3f(2, -1, 4)).norm(), 1e-5f);
  orbit.turn(static_cast<float>(kPi), 0);  // about the target, which came along
  EXPECT_LT((eye() - Vec3f(2, -1, -4)).norm(), 1e-5f);
}

}  // namespace
}  // namespace lightwell::render
