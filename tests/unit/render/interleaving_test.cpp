// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/unit/render/render_fixture.h"

namespace lightwell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

// Many weak lights all over the upper hemisphere, or about one direction.
LightSet many_lights(int count, std::optional<Vec3f> about = std::nullopt) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> uniform(-1, 1);
  LightSet lights;
  for (int i = 0; i < count; ++i) {
    DirectionalLight light;
    const Vec3f any(uniform(random), uniform(random), uniform(random));
    light.direction = about ? (*about + 0.5f * any).normalized() : any.normalized();
    if (!about) light.direction.y() = std::abs(light.direction.y());
    light.illuminance = Rgb(100, 60, 3) * (uniform(random) + 1.5f);
    lights.lights.push_back(light);
  }
  return lights;
}

double relative_rmse(const render::RadiancePicture& picture, const render::RadiancePicture& exact) {
  double error = 0;
  double sum = 0;
  for (std::size_t i = 0; i < exact.rgba.size(); ++i) {
    error += std::pow(static_cast<double>(picture.rgba[i] - exact.rgba[i]), 2);
    sum += std::pow(static_cast<double>(exact.rgba[i]), 2);
  }
  return std::sqrt(error / std::max(sum, 1e-30));
}

class Interleaving : public Rendering {
 protected:
  static render::RadiancePicture picture_of(const Scene& scene, const LightSet& lights,
                                            const SceneCamera& camera, int interleave, int width = 64,
                                            int height = 48, bool shadows = true, int samples = 1) {
    render::RendererOptions options;
    options.width = width;
    options.height = height;
    options.interleave = interleave;
    options.samples = samples;
    options.shadow_size = 64;
    auto renderer = render::Renderer::create(scene, options);
    EXPECT_TRUE(renderer.ok()) << renderer.error().message;
    EXPECT_TRUE(renderer->set_shadows(shadows));
    const Status status = renderer->render(lights, camera);
    EXPECT_TRUE(status.ok()) << status.error().message;
    return renderer->radiance();
  }

  // Every pixel as without interleaving: neither colour nor alpha may differ by more than a share of the brightest.
  static void expect_same(const render::RadiancePicture& picture, const render::RadiancePicture& exact,
                          float share) {
    ASSERT_EQ(picture.rgba.size(), exact.rgba.size());
    const float most = *std::max_element(exact.rgba.begin(), exact.rgba.end());
    int wrong = 0;
    for (std::size_t i = 0; i < exact.rgba.size(); ++i)
      if (!(std::abs(picture.rgba[i] - exact.rgba[i]) <= share * most)) ++wrong;
    EXPECT_EQ(wrong, 0) << "of " << exact.rgba.size() << " values";
  }
};

// Halves keep 11 bits, so that a subset is right to 2⁻¹²; and the filter's weights add up.
constexpr float kRounding = 5e-4f;

TEST_F(Interleaving, AllSubsetsTogetherAreAllLightsOnAPlane) {
  Scene scene;
  add_ground(scene, lambertian(Rgb(0.8f, 0.5f, 0.1f)));
  const LightSet lights = many_lights(400);
  Rgb expected = Rgb::Zero();
  for (const DirectionalLight& light : lights.lights)
    expected += Rgb(0.8f, 0.5f, 0.1f) * light.illuminance / static_cast<float>(kPi) * light.direction.y();
  for (const int interleave : {1, 2, 4}) {
    const auto p = picture_of(scene, lights, camera_at({0, 3, 0}, {0, 0, 0}), interleave);
    for (int y = 0; y < p.height; ++y)
      for (int x = 0; x < p.width; ++x)
        EXPECT_LE(((rgb(p, x, y) - expected) / expected).abs().maxCoeff(), kRounding) << x << ", " << y;
  }
}

// A wall of red diodes: two channels of nothing, and next to nothing.
TEST_F(Interleaving, AChannelWithoutLightIsBlackAndTheOthersAsTheyAre) {
  Scene scene;
  add_ground(scene, lambertian(Rgb::Constant(0.5f)));
  for (const float least : {0.0f, 1e-36f}) {
    LightSet lights = many_lights(72);
    for (DirectionalLight& light : lights.lights) light.illuminance = Rgb(100, 0, least);
    const SceneCamera camera = camera_at({0, 3, 0}, {0, 0, 0});
    const auto exact = picture_of(scene, lights, camera, 1);
    for (const int interleave : {2, 4}) {
      const auto p = picture_of(scene, lights, camera, interleave);
      for (int y = 0; y < p.height; ++y)
        for (int x = 0; x < p.width; ++x) {
          const Rgb value = rgb(p, x, y);
          EXPECT_NEAR(value[0] / rgb(exact, x, y)[0], 1, kRounding);
          EXPECT_EQ(value[1], 0);
          EXPECT_TRUE(value[2] >= 0 && value[2] < 1e-30f) << value[2];
        }
    }
  }
}

TEST_F(Interleaving, NothingLeaksAcrossAnEdgeOfDepthOrNormal) {
  Scene scene;
  // A step whose top is parallel to the ground, seen from above: only depth tells them apart; its sides by their normals.
  // The ground is dark, and a filter that took from it what lights the top would be right: so light comes from one side, and
  // every face is lit by its own share.
  add_ground(scene, lambertian(Rgb::Constant(0.5f)));
  add_box(scene, {-0.7f, 0, -0.5f}, {0.4f, 0.8f, 0.6f}, lambertian(Rgb::Constant(0.5f)));
  add_box(scene, {0.9f, 0, -0.5f}, {1, 0.2f, 0.6f}, lambertian(Rgb::Constant(0.5f)));
  const LightSet lights = many_lights(200, Vec3f(1, 0.5f, 0.7f));
  const SceneCamera camera = camera_at({2, 4, 3}, {0, 0.3f, 0});
  const auto exact = picture_of(scene, lights, camera, 1, 64, 48, false);
  // Faces are plane and without shadows: what is right for one pixel of a face is right for all. With fewer partners than the
  // whole window a part of the subsets stands for all: 60 % of them err by a few percent at the most, other faces by half.
  for (const int interleave : {2, 4})
    expect_same(picture_of(scene, lights, camera, interleave, 64, 48, false), exact, 0.08f);
}

TEST_F(Interleaving, AShadowOnTheGroundDoesNotReachTheTopAboveIt) {
  Scene scene;
  // Black is all that lies in shadow of a roof, and the roof itself is lit: equal normals and materials, other depths.
  add_ground(scene, lambertian(Rgb::Constant(0.5f)));
  add_box(scene, {-1, 0.9f, -1}, {1, 1, 1}, lambertian(Rgb::Constant(0.5f)));
  const LightSet lights = many_lights(200, Vec3f(0, 1, 0));
  const SceneCamera camera = camera_at({0, 6, 0.01f}, {0, 0, 0});
  const auto exact = picture_of(scene, lights, camera, 1);
  for (const int interleave : {2, 4}) {
    const auto p = picture_of(scene, lights, camera, interleave);
    int tops = 0;
    for (int y = 0; y < p.height; ++y)
      for (int x = 0; x < p.width; ++x) {
        if (rgb(exact, x, y).minCoeff() < 0.999f * rgb(exact, 32, 24).minCoeff()) continue;  // not the roof
        ++tops;
        EXPECT_LE(((rgb(p, x, y) - rgb(exact, x, y)) / rgb(exact, x, y)).abs().maxCoeff(), 0.08f)
            << x << ", " << y;
      }
    EXPECT_GT(tops, 200);
  }
}

TEST_F(Interleaving, AMattSurfaceDoesNotTakeTheLobeOfAGlossyOneBesideIt) {
  Scene scene;
  Material glossy = lambertian(Rgb::Zero());
  glossy.specular = Rgb::Constant(0.9f);
  glossy.exponent = 20;
  add_box(scene, {-2, -0.1f, -2}, {0, 0, 2}, glossy);
  add_box(scene, {0, -0.1f, -2}, {2, 0, 2}, lambertian(Rgb::Constant(0.05f)));
  const LightSet lights = many_lights(200, Vec3f(0, 1, -1));
  const SceneCamera camera = camera_at({0, 2, 2}, {0, 0, 0});
  const auto exact = picture_of(scene, lights, camera, 1, 64, 48, false);
  for (const int interleave : {2, 4}) {
    const auto p = picture_of(scene, lights, camera, interleave, 64, 48, false);
    // The column beside the edge: a leak would make it many times as bright.
    for (int y = 8; y < 40; ++y)
      for (const int x : {33, 34, 35})
        EXPECT_LE(((rgb(p, x, y) - rgb(exact, x, y)) / rgb(exact, x, y)).abs().maxCoeff(), 0.08f)
            << x << ", " << y;
  }
}

TEST_F(Interleaving, APatternOnASurfaceStaysSharp) {
  Scene scene;
  add_ground(scene, lambertian(Rgb::Constant(0.8f)));
  std::mt19937 random(5);
  for (Vertex& v : scene.vertices) v.color = {static_cast<std::uint16_t>(random()), 20000, 60000, 65535};
  const LightSet lights = many_lights(100);
  const SceneCamera camera = camera_at({0, 3, 0}, {0, 0, 0});
  expect_same(picture_of(scene, lights, camera, 4), picture_of(scene, lights, camera, 1), 1e-3f);
}

class AnyPicture : public Interleaving {
 protected:
  void SetUp() override {
    Interleaving::SetUp();
    add_ground(scene_, lambertian(Rgb::Constant(0.5f)));
    add_sphere(scene_, {0, 0.6f, 0}, 0.5f, lambertian(Rgb::Constant(0.5f)));
    add_box(scene_, {0.8f, 0, 0}, {1, 1.5f, 0.2f}, lambertian(Rgb::Constant(0.5f)));
  }
  Scene scene_;
  SceneCamera camera_ = camera_at({2, 2, 3}, {0, 0.5f, 0});
};

TEST_F(AnyPicture, OfAnyNumberOfLightsIsNearlyTheOneWithout) {
  for (const int count : {0, 1, 3, 72, 5000}) {
    const LightSet lights = many_lights(count);
    const auto exact = picture_of(scene_, lights, camera_, 1);
    for (const int interleave : {2, 4}) {
      const auto p = picture_of(scene_, lights, camera_, interleave);
      if (count <= 3)
        EXPECT_EQ(p.rgba, exact.rgba) << count;  // too few to share
      else
        EXPECT_LE(relative_rmse(p, exact), 0.03) << count;  // edges at 64 pixels across are everywhere
    }
  }
}

TEST_F(AnyPicture, OfAnySizeIsNearlyTheOneWithout) {
  const LightSet lights = many_lights(72);
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(3, 5), std::pair(641, 359)}) {
    // In the tiny ones a whole shadow lies between two pixels: they are compared without.
    const bool shadows = width > 100;
    const auto exact = picture_of(scene_, lights, camera_, 1, width, height, shadows);
    for (const int interleave : {2, 4})
      EXPECT_LE(relative_rmse(picture_of(scene_, lights, camera_, interleave, width, height, shadows), exact),
                0.03)
          << width << " × " << height << ", " << interleave;
  }
}

TEST_F(AnyPicture, WithManySamplesAPixelHasItsCoverage) {
  const LightSet lights = many_lights(72);
  const SceneCamera far = camera_at({8, 8, 12}, {0, 0.5f, 0});
  const auto exact = picture_of(scene_, lights, far, 1, 64, 48, true, 4);
  const auto p = picture_of(scene_, lights, far, 4, 64, 48, true, 4);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) EXPECT_EQ(alpha(p, x, y), alpha(exact, x, y));
  EXPECT_LE(relative_rmse(p, exact), 0.03);
}

}  // namespace
}  // namespace lightwell
