// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "render/probe_balls.h"
#include "tests/unit/render/render_fixture.h"

namespace lightwell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

// Light is linear: whatever unit a light set counts in, a picture is the same times its power.
class LightPower : public Rendering, public ::testing::WithParamInterface<int> {
 protected:
  [[nodiscard]] float power() const { return std::pow(10.0f, static_cast<float>(GetParam())); }
  [[nodiscard]] LightSet lights(float power) const {
    LightSet set = light_set({{Vec3f::UnitY(), Rgb(3, 2, 1) * power}, {{-1, 1, 0}, Rgb(1, 1, 4) * power}});
    set.ambient = Rgb(0.1f, 0.2f, 0.3f) * power;
    return set;
  }
  const Rgb albedo_{0.18f, 0.5f, 0.03f};
  // Half floats of the albedo.
  static constexpr float kTolerance = 5e-4f;
};

TEST_P(LightPower, ADiffuseSurfaceReturnsItsAlbedoOfTheLight) {
  Scene scene;
  add_ground(scene, lambertian(albedo_));
  const auto p = picture(scene, lights(power()), camera_at({0, 3, 0.01f}, {0, 0, 0}));
  const Rgb expected = albedo_ * ((Rgb(3, 2, 1) + Rgb(1, 1, 4) * std::sqrt(0.5f)) / static_cast<float>(kPi) +
                                  Rgb(0.1f, 0.2f, 0.3f));
  expect_near(rgb(p, 16, 12) / power(), expected, kTolerance);
}

TEST_P(LightPower, GlossAndMetalAreTheSameTimesThePower) {
  Material phong = lambertian(albedo_);
  phong.specular = Rgb(0.1f, 0.3f, 0.2f);
  phong.exponent = 40;
  Material metal;
  metal.base_color = albedo_;
  metal.metallic = 1;
  metal.roughness = 0.02f;
  for (const Material& material : {phong, metal}) {
    Scene scene;
    add_ground(scene, lambertian(albedo_));
    add_sphere(scene, {0, 1, 0}, 1, material, true, 24);
    const SceneCamera camera = camera_at({0, 1, 6}, {0, 1, 0}, 0.6f);
    const auto one = picture(scene, lights(1), camera);
    const auto p = picture(scene, lights(power()), camera);
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 32; ++x)
        // A dozen roundings of floats.
        ASSERT_LE((rgb(p, x, y) / power() - rgb(one, x, y)).abs().maxCoeff(),
                  2e-6f * rgb(one, x, y).maxCoeff())
            << x << "," << y;
  }
}

TEST_P(LightPower, ReinhardsPictureDoesNotDependOnIt) {
  Scene scene;
  add_ground(scene, lambertian(albedo_));
  add_sphere(scene, {0, 1, 0}, 1, lambertian({0.5f, 0.1f, 0.7f}), true, 24);
  const auto shown = [&](float power, const LightSet& set) {
    render::RendererOptions options;
    options.width = 32;
    options.height = 24;
    auto renderer = render::Renderer::create(scene, options);
    EXPECT_TRUE(renderer.ok());
    EXPECT_TRUE(renderer->render(set, camera_at({0, 3, 6}, {0, 0, 0})));
    EXPECT_TRUE(renderer->lay_over(render::grey_ball(set, render::Mat4f::Identity(), 8), 0, 0));
    renderer->tone_map(0.04);
    // Stops from 1 / 8 of the power.
    EXPECT_GT(renderer->exposure_ev100(), std::log2(power) - 3);
    EXPECT_LT(renderer->exposure_ev100(), std::log2(power) + 6);
    return renderer->display();
  };
  const auto one = shown(1, lights(1));
  const auto p = shown(power(), lights(power()));
  for (std::size_t i = 0; i < one.rgba.size(); ++i)
    ASSERT_NEAR(p.rgba[i], one.rgba[i], 1) << i;  // a rounding
}

TEST_P(LightPower, AShadowOnAPlateIsTheSameRatio) {
  Scene scene;
  add_ground(scene, lambertian(albedo_));
  add_box(scene, {-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}, lambertian(albedo_));
  const auto over = [&](float power) {
    render::RendererOptions options;
    options.width = 120;
    options.height = 90;
    auto renderer = render::Renderer::create(scene, options);
    EXPECT_TRUE(renderer.ok());
    EXPECT_TRUE(renderer->set_plate({1, 1, {Rgb(0.2f, 0.5f, 0.7f)}, true, ""}, power));
    EXPECT_TRUE(renderer->render(lights(power), camera_at({0, 12, 0.01f}, {0, 0, 0}, 0.6f)));
    renderer->tone_map(0.04);
    return std::pair(renderer->radiance(), renderer->display());
  };
  const auto [one, one_shown] = over(1);
  const auto [p, p_shown] = over(power());
  for (std::size_t i = 0; i < one.rgba.size(); ++i) {
    if (i % 4 != 3) {
      ASSERT_NEAR(p.rgba[i] / power(), one.rgba[i], 2e-6f) << i;
    }  // a dozen roundings of floats
    ASSERT_NEAR(p_shown.rgba[i], one_shown.rgba[i], 1) << i;
  }
}

TEST_P(LightPower, EmissionIsRadianceAsItIs) {
  Scene scene;
  Material lamp = lambertian(Rgb::Zero());
  lamp.emission = Rgb(1, 0.3f, 0.1f) * power();
  add_ground(scene, lamp);
  const auto p = picture(scene, {}, camera_at({0, 3, 0.01f}, {0, 0, 0}));
  expect_near(rgb(p, 16, 12) / power(), Rgb(1, 0.3f, 0.1f), 2e-6f);
}

TEST_P(LightPower, FewerLightsKeepAllOfIt) {
  for (const bool parents : {false, true}) {
    LightSet set = lights(power());
    set.has_parents = parents;
    if (parents) set.lights[1].parent = 0;
    const LightSet few = take_lights(set, 1);
    expect_near(few.lights[0].illuminance / power(), Rgb(4, 3, 5), 1e-6f);
  }
}

}  // namespace
INSTANTIATE_TEST_SUITE_P(Powers, LightPower, ::testing::Values(-30, -20, -12, -6, 0, 6, 12, 20, 30));
}  // namespace lightwell
