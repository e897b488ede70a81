// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/unit/render/render_fixture.h"

namespace lightwell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

const Rgb kWhite = Rgb::Constant(0.5f);
const Rgb kLux = Rgb::Constant(1000);
constexpr int kWidth = 200, kHeight = 60;

class SoftShadows : public Rendering {
 protected:
  static render::RadiancePicture drawn(const Scene& scene, const LightSet& lights, const SceneCamera& camera,
                                       bool soft_edges = true) {
    render::RendererOptions options;
    options.width = kWidth;
    options.height = kHeight;
    options.soft_edges = soft_edges;
    auto renderer = render::Renderer::create(scene, options);
    EXPECT_TRUE(renderer.ok()) << renderer.error().message;
    EXPECT_TRUE(renderer->render(lights, camera).ok());
    return renderer->radiance();
  }

  struct Lit {
    float x;        // from the edge of the slab, toward the light, metres
    float visible;  // part of the light
  };
  // Along the ground under a slab whose edge is the line x = 0 at a height, light from straight above.
  static std::vector<Lit> under_a_slab(float height, float radius_rad, bool soft_edges = true) {
    Scene scene;
    add_ground(scene, lambertian(kWhite));
    add_box(scene, {-3, height, -3}, {0, height + 0.02f, 3}, lambertian(kWhite));
    LightSet lights = light_set({{Vec3f::UnitY(), kLux}});
    lights.lights[0].angular_radius_rad = radius_rad;
    const SceneCamera camera = camera_at({0, 0.12f, 3}, {0, 0, 0}, 0.35f);
    const auto p = drawn(scene, lights, camera, soft_edges);
    const render::View view = render::make_view(camera, kWidth, kHeight);
    std::vector<Lit> found;
    for (int y = kHeight / 2; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const Vec3f ray = pixel_ray(view, x, y, kWidth, kHeight);
        if (ray.y() >= 0) continue;
        const Vec3f point = view.eye - ray * (view.eye.y() / ray.y());
        if (std::abs(point.z()) > 1.5f) continue;
        found.push_back({point.x(), rgb(p, x, y)[0] / (kWhite[0] * kLux[0] / static_cast<float>(kPi))});
      }
    return found;
  }
};

// Of a disc of radius 1, what a straight edge leaves at a distance t from its middle.
double beyond_edge(double t) {
  const double x = std::clamp(t, -1.0, 1.0);
  return 0.5 + (std::asin(x) + x * std::sqrt(1 - x * x)) / kPi;
}

TEST_F(SoftShadows, AnEdgeIsAsWideAsTheLightIsFromTheHeightOfWhatCasts) {
  for (const float height : {0.3f, 0.8f}) {
    const float radius = 0.2f;
    double error = 0;
    int count = 0;
    for (const Lit& lit : under_a_slab(height, radius)) {
      const double half_width = static_cast<double>(height * std::tan(radius));
      const double t = static_cast<double>(lit.x) / half_width;
      const double difference = std::abs(static_cast<double>(lit.visible) - beyond_edge(t));
      // Three of the twelve looks.
      EXPECT_LT(difference, 0.25) << height << " " << t;
      if (std::abs(t) > 1.1) {
        EXPECT_LT(difference, 1e-3) << height << " " << t;
      }
      if (std::abs(t) < 1) {
        error += difference;
        ++count;
      }
    }
    ASSERT_GT(count, 60);
    EXPECT_LT(error / count, 0.08);
  }
}

TEST_F(SoftShadows, ASunsEdgeIsSharp) {
  for (const Lit& lit : under_a_slab(0.8f, 0.00465f))
    // The edge is 3.7 mm to each side; a map's texel across the slab 25 mm.
    if (std::abs(lit.x) > 0.03f) {
      EXPECT_NEAR(lit.visible, lit.x > 0 ? 1.0f : 0.0f, 1e-3f) << lit.x;
    }
}

TEST_F(SoftShadows, HardEdgesAreThoseOfAPoint) {
  for (const Lit& lit : under_a_slab(0.8f, 0.2f, false))
    if (std::abs(lit.x) > 0.06f) {
      EXPECT_NEAR(lit.visible, lit.x > 0 ? 1.0f : 0.0f, 1e-3f) << lit.x;
    }
}

// Lights all over the sky return as much from a lobe whether they are points or as wide as they are apart.
TEST_F(SoftShadows, ALobeReturnsAsMuchOfWideLightsAsOfPoints) {
  constexpr int kLights = 2000;
  LightSet points;
  for (int i = 0; i < kLights; ++i) {
    const double y = (i + 0.5) / kLights;
    points.lights.push_back(
        {.direction = direction_from_spherical({std::acos(y), 2.399963 * i}).cast<float>(),
         .illuminance = kLux});
  }
  LightSet wide = points;
  for (DirectionalLight& light : wide.lights)
    light.angular_radius_rad = std::sqrt(2.0f / static_cast<float>(kLights));
  Material glossy = lambertian(Rgb::Zero());
  glossy.specular = kWhite;
  glossy.exponent = 40;
  Material metal;
  metal.model = Material::Model::metallic_roughness;
  metal.metallic = 1;
  metal.roughness = 0.4f;
  for (const Material& material : {glossy, metal}) {
    Scene scene;
    add_sphere(scene, {0, 0, 0}, 1, material);
    const SceneCamera camera = camera_at({0, 2, 4}, {0, 0, 0}, 0.4f);
    const auto a = drawn(scene, points, camera), b = drawn(scene, wide, camera);
    double sum_points = 0, sum_wide = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        if (!(alpha(a, x, y) > 0)) continue;
        sum_points += static_cast<double>(rgb(a, x, y)[1]);
        sum_wide += static_cast<double>(rgb(b, x, y)[1]);
      }
    EXPECT_GT(sum_points, 0);
    // The widened lobe reaches over the horizon of the lights by a hundredth of a radian.
    EXPECT_NEAR(sum_wide / sum_points, 1, 0.01);
  }
}

}  // namespace
}  // namespace lightwell
