// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "lighting/direction.h"
#include "tests/unit/render/render_fixture.h"

namespace lightwell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

// The G-buffer keeps normals in 2 × 16 bits and colours in half floats (2⁻¹¹): well within the promised 1e-3.
constexpr float kTolerance = 5e-4f;
const Rgb kAlbedo(0.8f, 0.5f, 0.1f);
const Rgb kLux(1000, 2000, 50);
const float kPiF = static_cast<float>(kPi);

Vec3f at_angle(double theta_deg) {
  const double theta = theta_deg * kPi / 180;
  return Vec3d(std::sin(theta), std::cos(theta), 0).cast<float>();
}

class Shading : public Rendering {
 protected:
  static render::RadiancePicture ground_under(const LightSet& lights,
                                              const Material& material = lambertian(kAlbedo)) {
    Scene scene;
    add_ground(scene, material);
    return picture(scene, lights, camera_at({0, 3, 0}, {0, 0, 0}));
  }
};

TEST_F(Shading, LambertianPlaneReturnsAlbedoOverPiTimesIlluminanceTimesCosine) {
  for (const double theta_deg : {0.0, 60.0, 85.0}) {
    const auto p = ground_under(light_set({{at_angle(theta_deg), kLux}}));
    const Rgb expected = kAlbedo * kLux / kPiF * static_cast<float>(std::cos(theta_deg * kPi / 180));
    for (int y = 0; y < p.height; y += 5)
      for (int x = 0; x < p.width; x += 5) expect_near(rgb(p, x, y), expected, kTolerance);
  }
}

TEST_F(Shading, LightsAdd) {
  const auto a = ground_under(light_set({{at_angle(10), kLux}}));
  const auto b = ground_under(light_set({{at_angle(50), kLux / 3}}));
  const auto both = ground_under(light_set({{at_angle(10), kLux}, {at_angle(50), kLux / 3}}));
  expect_near(rgb(both, 9, 9), rgb(a, 9, 9) + rgb(b, 9, 9), 1e-5f);
}

TEST_F(Shading, LightBelowTheHorizonAndBlackLightAddNothing) {
  const auto p =
      ground_under(light_set({{at_angle(91), kLux}, {at_angle(180), kLux}, {at_angle(0), Rgb::Zero()}}));
  EXPECT_EQ(rgb(p, 5, 5).maxCoeff(), 0);
  EXPECT_EQ(alpha(p, 5, 5), 1);
}

TEST_F(Shading, NoLightsAtAllIsABlackSurface) {
  const auto p = ground_under(light_set({}));
  EXPECT_EQ(rgb(p, 5, 5).maxCoeff(), 0);
  EXPECT_EQ(alpha(p, 5, 5), 1);
}

TEST_F(Shading, AmbientRadianceReturnsTimesAlbedo) {
  LightSet lights = light_set({});
  lights.ambient = Rgb(2, 3, 4);
  expect_near(rgb(ground_under(lights), 5, 5), kAlbedo * lights.ambient, kTolerance);
}

TEST_F(Shading, AnyNumberOfLightsSumsToTheClosedForm) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (const int count : {1, 256, 257, 300, 1000}) {
    LightSet lights;
    Rgb expected = Rgb::Zero();
    for (int i = 0; i < count; ++i) {
      DirectionalLight light;
      light.direction =
          Vec3f(uniform(random), std::abs(uniform(random)) + 0.05f, uniform(random)).normalized();
      light.illuminance = kLux * (uniform(random) + 1);
      expected += kAlbedo * light.illuminance / kPiF * light.direction.y();
      lights.lights.push_back(light);
    }
    expect_near(rgb(ground_under(lights), 7, 7), expected, kTolerance, std::to_string(count) + " lights");
  }
}

// One pixel whose ray meets the ground at 45°, light in the mirror direction.
TEST_F(Shading, PhongReachesItsClosedFormInTheMirrorDirection) {
  for (const float exponent : {1.0f, 20.0f, 500.0f}) {
    Material m = lambertian(kAlbedo);
    m.specular = Rgb(0.3f, 0.2f, 0.1f);
    m.exponent = exponent;
    Scene scene;
    add_ground(scene, m);
    const Vec3f mirror = Vec3f(-1, 1, 0).normalized();
    const auto p = picture(scene, light_set({{mirror, kLux}}), camera_at({2, 2, 0}, {0, 0, 0}), 1, 1);
    const Rgb f = kAlbedo / kPiF + m.specular * (exponent + 2) / (2 * kPiF);
    // The normal's 16 bits are 3e-5 rad; the lobe of exponent 500 has no slope at its top.
    expect_near(rgb(p, 0, 0), f * kLux * mirror.y(), kTolerance, "exponent " + std::to_string(exponent));
  }
}

TEST_F(Shading, PhongLobeIsBlackBehindItsMirrorDirectionForEveryExponentButNought) {
  // Eye at 45°, light 60° on the eye's own side: 105° from the mirror direction.
  const double theta = 60 * kPi / 180;
  const Vec3f light = Vec3d(std::sin(theta), std::cos(theta), 0).cast<float>();
  for (const float exponent : {0.0f, 0.01f, 0.3f, 1.0f}) {
    Material m = lambertian(Rgb::Zero());
    m.specular = Rgb(0.3f, 0.2f, 0.1f);
    m.exponent = exponent;
    Scene scene;
    add_ground(scene, m);
    const auto p = picture(scene, light_set({{light, kLux}}), camera_at({2, 2, 0}, {0, 0, 0}), 1, 1);
    // 0⁰ is 1: a lobe without an exponent is even in all directions.
    const Rgb f = exponent == 0 ? Rgb(m.specular / kPiF) : Rgb(Rgb::Zero());
    expect_near(rgb(p, 0, 0), f * kLux * light.y(), kTolerance, "exponent " + std::to_string(exponent));
  }
}

TEST_F(Shading, PhongLobeReflectsItsSpecularAlbedoAtNormalIncidence) {
  // Σ over directions of f · cos · dω, with the eye along the normal, is specular for any exponent.
  Material m = lambertian(Rgb::Zero());
  m.specular = Rgb(0.3f, 0.3f, 0.3f);
  m.exponent = 30;
  LightSet lights;
  constexpr int kRings = 60;  // midpoint rule; a lobe of exponent 30 is 15° wide
  for (int r = 0; r < kRings; ++r)
    for (int s = 0; s < 4; ++s) {
      const double theta = kPi / 2 * (r + 0.5) / kRings;
      const double solid_angle = 2 * kPi / 4 * std::sin(theta) * kPi / 2 / kRings;
      DirectionalLight light;
      light.direction = direction_from_spherical({theta, s * kPi / 2}).cast<float>();
      light.illuminance = Rgb::Constant(static_cast<float>(solid_angle));
      lights.lights.push_back(light);
    }
  Scene scene;
  add_ground(scene, m);
  const auto p = picture(scene, lights, camera_at({0, 3, 0}, {0, 0, 0}), 1, 1);
  expect_near(rgb(p, 0, 0), m.specular, 2e-3f);  // the rule's own error at this width
}

TEST_F(Shading, MetallicRoughnessReachesItsClosedFormAtNormalIncidence) {
  for (const float metallic : {0.0f, 0.5f, 1.0f})
    for (const float roughness : {0.3f, 1.0f}) {
      Material m;
      m.base_color = kAlbedo;
      m.metallic = metallic;
      m.roughness = roughness;
      Scene scene;
      add_ground(scene, m);
      const auto p =
          picture(scene, light_set({{Vec3f::UnitY(), kLux}}), camera_at({0, 3, 0}, {0, 0, 0}), 1, 1);
      // D = 1 / (π α²), V = 1/4, F = F0 (glTF 2.0, appendix B.3).
      const float alpha = roughness * roughness;
      const Rgb f0 = 0.04f * (1 - metallic) + kAlbedo * metallic;
      const Rgb f = (1 - f0) * kAlbedo * (1 - metallic) / kPiF + f0 / (4 * kPiF * alpha * alpha);
      expect_near(rgb(p, 0, 0), f * kLux, kTolerance);
    }
}

TEST_F(Shading, RoughMetalInAWhiteFurnaceNeverReturnsMoreThanItReceives) {
  Material m;
  m.base_color = Rgb::Ones();
  m.metallic = 1;
  LightSet lights;
  for (int r = 0; r < 40; ++r)
    for (int s = 0; s < 20; ++s) {
      const double theta = kPi / 2 * (r + 0.5) / 40;
      DirectionalLight light;
      light.direction = direction_from_spherical({theta, 2 * kPi * s / 20}).cast<float>();
      light.illuminance = Rgb::Constant(static_cast<float>(std::sin(theta) * kPi / 2 / 40 * 2 * kPi / 20));
      lights.lights.push_back(light);
    }
  for (const float roughness : {0.5f, 0.8f, 1.0f}) {
    m.roughness = roughness;
    Scene scene;
    add_ground(scene, m);
    const float white = rgb(picture(scene, lights, camera_at({2, 2, 0}, {0, 0, 0}), 1, 1), 0, 0)[0];
    EXPECT_LE(white, 1.002f);  // the midpoint rule's error
    EXPECT_GT(white, 0);
  }
}

TEST_F(Shading, ReflectionIsTheSameWithEyeAndLightExchanged) {
  const Vec3f a = Vec3f(1, 2, 0.5f).normalized();
  const Vec3f b = Vec3f(-0.8f, 0.7f, 0.9f).normalized();
  Material phong = lambertian(kAlbedo);
  phong.specular = Rgb::Constant(0.4f);
  phong.exponent = 3;
  std::vector<Material> materials = {phong};
  for (const float roughness : {0.2f, 0.5f, 1.0f}) {
    Material m;
    m.base_color = kAlbedo;
    m.metallic = 0.5f;
    m.roughness = roughness;
    materials.push_back(m);
  }
  for (const Material& m : materials) {
    Scene scene;
    add_ground(scene, m);
    const auto f = [&](const Vec3f& eye, const Vec3f& light) {
      return Rgb(rgb(picture(scene, light_set({{light, kLux}}), camera_at(3 * eye, {0, 0, 0}), 1, 1), 0, 0) /
                 light.y());
    };
    expect_near(f(a, b), f(b, a), kTolerance);
  }
}

TEST_F(Shading, BackOfASingleSidedSurfaceIsNotDrawnAndOfADoubleSidedOneIsLit) {
  Scene scene;
  add_ground(scene, lambertian(kAlbedo));
  const LightSet from_below = light_set({{-Vec3f::UnitY(), kLux}});
  const SceneCamera below = camera_at({0, -3, 0}, {0, 0, 0});
  EXPECT_EQ(alpha(picture(scene, from_below, below), 5, 5), 0);
  scene.materials[0].double_sided = true;
  expect_near(rgb(picture(scene, from_below, below), 5, 5), kAlbedo * kLux / kPiF, kTolerance);
}

TEST_F(Shading, OddSizesKeepTheirShape) {
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(321, 239), std::pair(2, 301)}) {
    Scene scene;
    add_ground(scene, lambertian(kAlbedo));
    const auto p =
        picture(scene, light_set({{Vec3f::UnitY(), kLux}}), camera_at({0, 3, 0}, {0, 0, 0}), width, height);
    ASSERT_EQ(p.rgba.size(), static_cast<std::size_t>(width * height * 4));
    expect_near(rgb(p, width - 1, height - 1), kAlbedo * kLux / kPiF, kTolerance);
  }
}

TEST_F(Shading, SamplesAntialiasEdgesAndLeaveInteriorsAlone) {
  Scene scene;
  add_ground(scene, lambertian(kAlbedo), false, 1.1f);
  const LightSet lights = light_set({{Vec3f::UnitY(), kLux}});
  const SceneCamera camera = camera_at({0, 4, 0}, {0, 0, 0});
  const auto one = picture(scene, lights, camera, 32, 24, 1);
  const auto many = picture(scene, lights, camera, 32, 24, 16);
  expect_near(rgb(many, 16, 12), rgb(one, 16, 12), 1e-5f);
  double area_one = 0;
  double area_many = 0;
  int partial = 0;
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 32; ++x) {
      area_one += alpha(one, x, y);
      area_many += alpha(many, x, y);
      partial += alpha(many, x, y) > 0.01f && alpha(many, x, y) < 0.99f;
    }
  // Pixels: the square's side over the picture's height, which is 2 · 4 · tan 0.3.
  const double side = 24 * 2 * 1.1 / (8 * std::tan(0.3));
  EXPECT_GT(partial, 0);
  // 16 Hammersley points know an edge's place in a pixel to 1/16; the border is 4 · side pixels long.
  EXPECT_NEAR(area_many, side * side, 4 * side / 16);
  EXPECT_NEAR(area_one, side * side, 4 * side / 2);
}

}  // namespace
}  // namespace lightwell
