// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/unit/render/render_fixture.h"

namespace lightwell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

class ShadowCache : public Rendering {
 protected:
  void SetUp() override {
    Rendering::SetUp();
    add_ground(scene_, lambertian(Rgb::Constant(0.5f)));
    add_sphere(scene_, {0, 0.6f, 0}, 0.5f, lambertian(Rgb::Constant(0.5f)));
    add_box(scene_, {0.8f, 0, 0}, {1, 1.5f, 0.2f}, lambertian(Rgb::Constant(0.5f)));
  }

  [[nodiscard]] render::Renderer renderer() const {
    render::RendererOptions options;
    options.width = 160;
    options.height = 120;
    options.shadow_size = 64;
    auto made = render::Renderer::create(scene_, options);
    EXPECT_TRUE(made.ok());
    return std::move(made).value();
  }

  static LightSet some_lights(unsigned seed, int count = 24) {
    std::mt19937 random(seed);
    std::normal_distribution<float> normal;
    std::lognormal_distribution<float> power(0, 1.5);
    std::vector<std::pair<Vec3f, Rgb>> lights;
    for (int i = 0; i < count; ++i) {
      Vec3f d(normal(random), std::abs(normal(random)) + 0.05f, normal(random));
      lights.emplace_back(d.normalized(), Rgb::Constant(100 * power(random)));
    }
    LightSet set = light_set({});
    for (const auto& [d, e] : lights) {
      DirectionalLight light;
      light.direction = d;
      light.illuminance = e;
      set.lights.push_back(light);
    }
    return set;
  }

  void expect_as_if_drawn_anew(const render::Renderer& there, const LightSet& lights, float most) const {
    render::Renderer anew = renderer();
    ASSERT_TRUE(anew.render(lights, camera_).ok());
    const auto a = there.radiance(), b = anew.radiance();
    double sum = 0, of = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) {
      sum += std::pow(static_cast<double>(a.rgba[i] - b.rgba[i]), 2);
      of += std::pow(static_cast<double>(b.rgba[i]), 2);
    }
    EXPECT_LE(std::sqrt(sum / of), most);
  }

  Scene scene_;
  SceneCamera camera_ = camera_at({0, 4, 4}, {0, 0, 0}, 0.7f);
};

TEST_F(ShadowCache, LightsThatStandAreNotDrawnAgainWhateverTheirPower) {
  auto there = renderer();
  LightSet lights = some_lights(1);
  ASSERT_TRUE(there.render(lights, camera_).ok());
  EXPECT_EQ(there.shadow_maps_drawn(), lights.lights.size());
  for (DirectionalLight& light : lights.lights) light.illuminance *= 1.1f;
  std::swap(lights.lights[3], lights.lights[9]);
  ASSERT_TRUE(there.render(lights, camera_).ok());
  EXPECT_EQ(there.shadow_maps_drawn(), 0u);
  expect_as_if_drawn_anew(there, lights, 1e-6f);
}

TEST_F(ShadowCache, OfLightsThatMoveOnlyTheirMapsAreDrawn) {
  auto there = renderer();
  LightSet lights = some_lights(2);
  ASSERT_TRUE(there.render(lights, camera_).ok());
  for (const std::size_t i : {4u, 11u})
    lights.lights[i].direction = (lights.lights[i].direction + Vec3f(0.2f, 0, 0)).normalized();
  ASSERT_TRUE(there.render(lights, camera_).ok());
  EXPECT_EQ(there.shadow_maps_drawn(), 2u);
  EXPECT_EQ(there.shadow_maps(), lights.lights.size());
  expect_as_if_drawn_anew(there, lights, 1e-6f);
}

TEST_F(ShadowCache, AMoveTooSmallToSeeIsLeftAndAddsUpUntilItIsDrawn) {
  auto there = renderer();
  LightSet lights = some_lights(3, 1);
  ASSERT_TRUE(there.render(lights, camera_).ok());
  std::size_t drawn = 0;
  for (int frame = 0; frame < 60; ++frame) {
    lights.lights[0].direction = (lights.lights[0].direction + Vec3f(0.0005f, 0, 0)).normalized();
    ASSERT_TRUE(there.render(lights, camera_).ok());
    drawn += there.shadow_maps_drawn();
    if (frame % 20 == 19)
      expect_as_if_drawn_anew(there, lights, 0.05f);  // a quarter of a texel of 64, along every edge
  }
  EXPECT_GE(drawn, 2u);
  EXPECT_LE(drawn, 12u);
}

// 64 lights of 512² fill an atlas of 4096²: where they do not fit as they stand, a sun must not lose its texels.
TEST_F(ShadowCache, InAFullAtlasStrongLightsKeepTheirTexels) {
  render::RendererOptions options;
  options.width = 40;
  options.height = 30;
  options.shadow_size = 512;
  auto made = render::Renderer::create(scene_, options);
  ASSERT_TRUE(made.ok());
  for (unsigned frame = 0; frame < 6; ++frame) {
    LightSet lights = some_lights(frame, 64);
    lights.lights[0].direction = Vec3f(0.3f, 1, 0.2f).normalized();
    lights.lights[0].illuminance = Rgb::Constant(1e5f);
    ASSERT_TRUE(made->render(lights, camera_).ok());
    EXPECT_GE(made->largest_map(), 1024) << frame;
  }
}

// 64 maps of 512² fill a page of 4096².
TEST_F(ShadowCache, LightsOfManyPagesStandAndLightAsFewAtATime) {
  render::RendererOptions options;
  options.width = 160;
  options.height = 120;
  options.shadow_size = 512;
  auto made = render::Renderer::create(scene_, options);
  ASSERT_TRUE(made.ok());
  const LightSet all = some_lights(5, 150);
  ASSERT_TRUE(made->render(all, camera_).ok());
  EXPECT_EQ(made->shadow_maps_drawn(), 150u);
  ASSERT_TRUE(made->render(all, camera_).ok());
  EXPECT_EQ(made->shadow_maps_drawn(), 0u);
  const auto together = made->radiance();

  std::vector<float> sum(together.rgba.size());
  for (const std::size_t first : {0u, 50u, 100u}) {
    LightSet part = all;
    part.lights.assign(all.lights.begin() + static_cast<std::ptrdiff_t>(first),
                       all.lights.begin() + static_cast<std::ptrdiff_t>(first) + 50);
    auto few = render::Renderer::create(scene_, options);
    ASSERT_TRUE(few.ok());
    ASSERT_TRUE(few->render(part, camera_).ok());
    const auto picture = few->radiance();
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += i % 4 == 3 ? 0 : picture.rgba[i];
  }
  double difference = 0, of = 0;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    if (i % 4 == 3) continue;
    difference += std::pow(static_cast<double>(sum[i] - together.rgba[i]), 2);
    of += std::pow(static_cast<double>(sum[i]), 2);
  }
  // Sides may be a step off: shadows' edges, a texel wide.
  EXPECT_LE(std::sqrt(difference / of), 0.01);
}

// A map that stands says nothing of how wide its light is now.
TEST_F(ShadowCache, ALightMayWidenWhileItsMapStands) {
  for (Material& material : scene_.materials) {
    material.specular = Rgb::Constant(0.5f);
    material.exponent = 50;
  }
  auto there = renderer();
  LightSet lights = some_lights(1, 20);
  for (const float radius : {0.01f, 0.2f, 0.05f}) {
    for (DirectionalLight& light : lights.lights) light.angular_radius_rad = radius;
    ASSERT_TRUE(there.render(lights, camera_).ok());
    expect_as_if_drawn_anew(there, lights, 0.001f);
  }
}

TEST_F(ShadowCache, AnyHistoryGivesThePictureOfAFirstFrame) {
  auto there = renderer();
  for (unsigned frame = 0; frame < 12; ++frame) {
    const LightSet lights = some_lights(frame / 2, frame % 3 == 0 ? 60 : 7 + static_cast<int>(frame));
    ASSERT_TRUE(there.render(lights, camera_).ok());
    // Sides that were kept may be a step off: shadows' edges, a texel wide.
    expect_as_if_drawn_anew(there, lights, 0.03f);
  }
}

}  // namespace
}  // namespace lightwell
