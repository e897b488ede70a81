// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/probe_balls.h"

#include <gtest/gtest.h>

#include "lighting/direction.h"
#include "tests/unit/render/render_fixture.h"

namespace lightwell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

constexpr int kSize = 41;

class ProbeBalls : public Rendering {
 protected:
  // Calls check(x, y, normal in the world) for every pixel of the ball; what is outside has alpha 0.
  template <class Check>
  static void for_ball(const render::RadiancePicture& ball, const render::Mat4f& world_from_camera,
                       Check check) {
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const float right = 2 * (static_cast<float>(x) + 0.5f) / kSize - 1;
        const float up = 1 - 2 * (static_cast<float>(y) + 0.5f) / kSize;
        const float square = right * right + up * up;
        ASSERT_EQ(alpha(ball, x, y), square <= 1 ? 1 : 0);
        if (square > 1) continue;
        const Vec3f n(right, up, std::sqrt(1 - square));
        check(x, y, Vec3f(world_from_camera.topLeftCorner<3, 3>() * n));
      }
  }
};

TEST_F(ProbeBalls, GreyUnderOneLightIsAlbedoOverPiTimesTheCosine) {
  const render::Mat4f camera = camera_at({3, 2, 4}, {0, 0, 0}).world_from_camera;
  const Vec3f d = Vec3f(1, 2, -0.5f).normalized();
  LightSet lights = light_set({{d, Rgb(1000, 500, 10)}});
  lights.ambient = Rgb(1, 2, 3);
  const auto ball = render::grey_ball(lights, camera, kSize);
  for_ball(ball, camera, [&](int x, int y, const Vec3f& n) {
    const Rgb expected =
        0.18f *
        (lights.lights[0].illuminance * std::max(0.0f, n.dot(d)) / static_cast<float>(kPi) + lights.ambient);
    expect_near(rgb(ball, x, y), expected, 1e-5f);  // float rounding
  });
}

TEST_F(ProbeBalls, MirrorShowsTheMapWhereTheReflectedRayPoints) {
  // A map that is linear in its pixels' direction cosines, on a fine grid: bilinear look-up errs by its curvature.
  LatLongImage map{720, 360, {}};
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const double theta = kPi * (y + 0.5) / map.height;
      const double lambda = kPi * (1 - 2 * (x + 0.5) / map.width);
      const Vec3d v(std::sin(theta) * std::sin(lambda), std::cos(theta), std::sin(theta) * std::cos(lambda));
      map.pixels.emplace_back((v.array() + 2).cast<float>());
    }
  const render::Mat4f camera = camera_at({3, 2, 4}, {0, 0, 0}).world_from_camera;
  const Vec3f to_eye = camera.col(2).head<3>();
  for (const double turn : {0.0, 1.0}) {
    const auto ball = render::mirror_ball(map, turn, camera, kSize);
    for_ball(ball, camera, [&](int x, int y, const Vec3f& n) {
      const Vec3f ray = 2 * n.dot(to_eye) * n - to_eye;
      // What stood at azimuth λ is seen at λ + turn.
      const Vec3f before = Eigen::AngleAxisf(static_cast<float>(-turn), Vec3f::UnitY()) * ray;
      // A pixel is 0.5°: (0.0087)²/8 of curvature, and up to half of a pixel beyond the poles' rows.
      expect_near(rgb(ball, x, y), before.array() + 2, 2e-3f);
    });
  }
}

TEST_F(ProbeBalls, AMirrorOfAOnePixelMapIsThatColour) {
  const auto ball = render::mirror_ball({1, 1, {Rgb(3, 1e8f, 0)}}, 0.3, render::Mat4f::Identity(), 9);
  EXPECT_TRUE((rgb(ball, 4, 4) == Rgb(3, 1e8f, 0)).all());
  EXPECT_TRUE((rgb(ball, 1, 2) == Rgb(3, 1e8f, 0)).all());
}

TEST_F(ProbeBalls, LieOverThePictureAndLeaveTheRestAlone) {
  Scene scene;
  add_ground(scene, lambertian(Rgb::Ones()));
  render::RendererOptions options;
  options.width = 20;
  options.height = 16;
  auto renderer = render::Renderer::create(scene, options);
  ASSERT_TRUE(renderer.ok());
  ASSERT_TRUE(
      renderer->render(light_set({{Vec3f::UnitY(), Rgb::Ones()}}), camera_at({0, 3, 0.01f}, {0, 0, 0})));
  const auto before = renderer->radiance();
  render::RadiancePicture over{3, 2, std::vector<float>(24, 0.0f)};
  for (int i = 0; i < 6; ++i) over.rgba[static_cast<std::size_t>(4 * i)] = static_cast<float>(i + 10);
  for (const int i : {0, 5}) over.rgba[static_cast<std::size_t>(4 * i + 3)] = 1;  // upper left, lower right
  ASSERT_TRUE(renderer->lay_over(over, 4, 5));
  const auto after = renderer->radiance();
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 20; ++x) {
      // Rows 5 and 6 from below are 10 and 9 from above.
      const float expected = x == 4 && y == 9 ? 10 : x == 6 && y == 10 ? 15 : rgb(before, x, y)[0];
      ASSERT_EQ(rgb(after, x, y)[0], expected) << x << "," << y;
    }
}

}  // namespace
}  // namespace lightwell
