// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/unit/render/render_fixture.h"

namespace lightwell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

const Rgb kWhite = Rgb::Constant(0.5f);
const Rgb kLux = Rgb::Constant(1000);
const float kPiF = static_cast<float>(kPi);
constexpr int kWidth = 160;
constexpr int kHeight = 120;

class Shadows : public Rendering {
 protected:
  // Calls check(pixel radiance, point) for every pixel whose ray meets the plane y = height.
  template <class Check>
  static void for_plane(const render::RadiancePicture& p, const SceneCamera& camera, float height,
                        Check check) {
    const render::View view = render::make_view(camera, p.width, p.height);
    for (int y = 0; y < p.height; ++y)
      for (int x = 0; x < p.width; ++x) {
        const Vec3f ray = pixel_ray(view, x, y, p.width, p.height);
        if (alpha(p, x, y) > 0 && ray.y() < 0)
          check(rgb(p, x, y), Vec3f(view.eye + ray * ((height - view.eye.y()) / ray.y())));
      }
  }
};

// Distance from a point's ray to the light to the sphere's centre; negative infinity where the sphere lies
// behind.
float miss(const Vec3f& point, const Vec3f& to_light, const Vec3f& centre) {
  const Vec3f offset = centre - point;
  if (offset.dot(to_light) < 0) return std::numeric_limits<float>::infinity();
  return (offset - offset.dot(to_light) * to_light).norm();
}

TEST_F(Shadows, SphereShadowsTheGroundWhereGeometrySays) {
  const Vec3f centre(0, 0.8f, 0);
  for (const Vec3f& light : {Vec3f(1, 1, 0.3f), Vec3f(-0.6f, 1, 0), Vec3f(0.6f, 0.25f, -1)}) {
    const Vec3f to_light = light.normalized();
    Scene scene;
    add_ground(scene, lambertian(kWhite));
    add_sphere(scene, centre, 0.5f, lambertian(kWhite));
    const SceneCamera camera = camera_at({0, 9, 0.01f}, {0, 0, 0}, 0.7f);
    const auto p = picture(scene, light_set({{to_light, kLux}}), camera, kWidth, kHeight);
    // Two texels of the map, across the light: 2 · 2 · 0.5 / 252 m, plus the tessellation's sagitta.
    constexpr float kMargin = 0.01f;
    int inside = 0;
    int outside = 0;
    for_plane(p, camera, 0, [&](const Rgb& value, const Vec3f& point) {
      // Only the ground: the sphere hides what is below it.
      if (miss(point, (render::make_view(camera, 1, 1).eye - point).normalized(), centre) < 0.52f) return;
      const float distance = miss(point, to_light, centre);
      if (distance < 0.5f - kMargin) {
        ++inside;
        EXPECT_EQ(value.maxCoeff(), 0) << point.transpose();
      } else if (distance > 0.5f + kMargin) {
        ++outside;
        expect_near(value, kWhite * kLux / kPiF * to_light.y(), 1e-3f);
      }
    });
    EXPECT_GT(inside, 50);
    EXPECT_GT(outside, 5000);
  }
}

TEST_F(Shadows, ShadowOfARestingObjectTouchesIt) {
  // A box on the ground, light from the left at 45°: the ground right of the box is dark from its foot on.
  Scene scene;
  add_ground(scene, lambertian(kWhite));
  add_box(scene, {-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}, lambertian(kWhite));
  const SceneCamera camera = camera_at({3, 5, 0}, {0.8f, 0, 0}, 0.4f);
  const auto p = picture(scene, light_set({{Vec3f(-1, 1, 0), kLux}}), camera, kWidth, kHeight);
  int dark = 0;
  for_plane(p, camera, 0, [&](const Rgb& value, const Vec3f& point) {
    if (point.x() < 0.5f || point.x() > 1.45f || std::abs(point.z()) > 0.45f) return;
    ++dark;
    EXPECT_EQ(value.maxCoeff(), 0) << point.transpose();
  });
  EXPECT_GT(dark, 200);
}

TEST_F(Shadows, UnshadowedFaceUnderGrazingLightEqualsTheClosedFormEverywhere) {
  // The box casts, so its top stands in every map: self-shadowing ("acne") would show as dark pixels.
  Scene scene;
  add_ground(scene, lambertian(kWhite), true);
  add_box(scene, {-1, 0, -1}, {1, 0.5f, 1}, lambertian(kWhite));
  const SceneCamera camera = camera_at({0, 5, 0}, {0, 0, 0}, 0.45f);
  for (const double elevation_deg : {2.0, 5.0, 20.0, 45.0, 89.0})
    for (const double azimuth_deg : {0.0, 17.0, 45.0, 200.0}) {
      const double e = elevation_deg * kPi / 180;
      const double a = azimuth_deg * kPi / 180;
      const Vec3f light =
          Vec3d(std::cos(e) * std::sin(a), std::sin(e), std::cos(e) * std::cos(a)).cast<float>();
      const auto p = picture(scene, light_set({{light, kLux}}), camera, kWidth, kHeight);
      for_plane(p, camera, 0.5f, [&](const Rgb& value, const Vec3f& point) {
        if (std::max(std::abs(point.x()), std::abs(point.z())) > 0.99f) return;
        // 16 bit normals leave 3e-5 of 1: 1e-3 of the cosine at 2°.
        expect_near(value, kWhite * kLux / kPiF * light.y(), 2e-3f);
      });
    }
}

TEST_F(Shadows, LitSideOfASphereHasNoShadowOnItself) {
  Scene scene;
  add_sphere(scene, {0, 0, 0}, 1, lambertian(kWhite));
  const SceneCamera camera = camera_at({0, 0, 5}, {0, 0, 0}, 0.5f);
  const Vec3f light = Vec3f(1, 0.4f, 0.5f).normalized();
  const auto p = picture(scene, light_set({{light, kLux}}), camera, kWidth, kHeight);
  const render::View view = render::make_view(camera, kWidth, kHeight);
  int checked = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const Vec3f ray = pixel_ray(view, x, y, kWidth, kHeight).normalized();
      const float along = -view.eye.dot(ray);
      const float squared = 1 - (view.eye + along * ray).squaredNorm();
      if (squared < 0.04f) continue;  // the silhouette, where facets differ from the sphere
      const Vec3f n = view.eye + (along - std::sqrt(squared)) * ray;
      // 60 rings: facets lie up to 1.5° off the sphere. Closer to the terminator than that a facet is in its
      // neighbour's shadow.
      if (n.dot(light) < 0.05f) continue;
      ++checked;
      EXPECT_NEAR(rgb(p, x, y)[0], 0.5f * 1000 / kPiF * n.dot(light), 0.5f * 1000 / kPiF * 5e-3f)
          << n.transpose();
    }
  EXPECT_GT(checked, 2000);
}

TEST_F(Shadows, ANodeThatCastsNoShadowOnlyReceives) {
  Scene scene;
  add_ground(scene, lambertian(kWhite));
  add_sphere(scene, {0, 0.8f, 0}, 0.5f, lambertian(kWhite), false);
  const SceneCamera camera = camera_at({0, 9, 0.01f}, {0, 0, 0}, 0.7f);
  const auto p = picture(scene, light_set({{Vec3f(1, 1, 0), kLux}}), camera, kWidth, kHeight);
  for_plane(p, camera, 0, [&](const Rgb& value, const Vec3f& point) {
    if (miss(point, (Vec3f(0, 9, 0.01f) - point).normalized(), {0, 0.8f, 0}) < 0.52f) return;
    expect_near(value, kWhite * kLux / kPiF * Vec3f(1, 1, 0).normalized().y(), 1e-3f);
  });
}

TEST_F(Shadows, AnOpenSheetCastsWhicheverSideFacesTheLight) {
  for (const bool facing_up : {true, false}) {
    Scene scene;
    add_ground(scene, lambertian(kWhite));
    const std::vector<std::uint32_t> up = {0, 1, 2, 0, 2, 3};
    const std::vector<std::uint32_t> down = {0, 2, 1, 0, 3, 2};
    add_mesh(scene, {{-0.5f, 1, -0.5f}, {-0.5f, 1, 0.5f}, {0.5f, 1, 0.5f}, {0.5f, 1, -0.5f}}, {},
             facing_up ? up : down, lambertian(kWhite));
    // From the side, so that the ground below the sheet is seen.
    const auto p =
        picture(scene, light_set({{Vec3f::UnitY(), kLux}}), camera_at({0, 0.5f, 4}, {0, 0, 0}), 33, 33);
    EXPECT_EQ(rgb(p, 16, 16).maxCoeff(), 0);
    EXPECT_EQ(alpha(p, 16, 16), 1);
  }
}

TEST_F(Shadows, AGroundThatCastsBlocksLightFromBelowAndKeepsTheMapsOfOtherLightsFine) {
  Scene scene;
  add_ground(scene, lambertian(kWhite), true, 50);
  add_sphere(scene, {0, 0.8f, 0}, 0.5f, lambertian(kWhite));
  // From below: the sphere hangs in the ground's shadow.
  const SceneCamera camera = camera_at({0, 0.6f, 4}, {0, 0.6f, 0}, 0.5f);
  const auto dark = picture(scene, light_set({{Vec3f(0.1f, -1, 0.3f), kLux}}), camera, 33, 33);
  for (int y = 0; y < 33; ++y)
    for (int x = 0; x < 33; ++x) EXPECT_EQ(rgb(dark, x, y).maxCoeff(), 0);
  // From above: the map fits the sphere, not the ground of 100 m, so the shadow has its size.
  const render::Casters casters = render::find_casters(scene);
  EXPECT_FALSE(casters.needs_supports(Vec3f(0.1f, 1, 0)));
  EXPECT_TRUE(casters.needs_supports(Vec3f(0.1f, -1, 0)));
  EXPECT_LT(casters.objects.radius, 0.51f);
}

// Floor and wall both support the scene; a sun that stands behind the wall alone passes over it.
TEST_F(Shadows, OfTwoSupportsOnlyTheOneBeforeTheLightIsInItsWay) {
  Scene scene;
  add_ground(scene, lambertian(kWhite), true, 4);
  add_mesh(scene, {{-4, 0, -4}, {4, 0, -4}, {4, 2, -4}, {-4, 2, -4}}, {}, {0, 1, 2, 0, 2, 3},
           lambertian(kWhite));
  const Vec3f centre(0, 0.8f, 0);
  add_sphere(scene, centre, 0.5f, lambertian(kWhite));
  const Vec3f to_light(0, std::sqrt(0.75f), -0.5f);
  const render::Casters casters = render::find_casters(scene);
  ASSERT_TRUE(casters.is_support[0] && casters.is_support[1]);
  const SceneCamera camera = camera_at({0, 9, 3}, {0, 0, 0}, 0.8f);
  const auto p = picture(scene, light_set({{to_light, kLux}}), camera, kWidth, kHeight);
  int lit = 0, behind_ball = 0;
  for_plane(p, camera, 0, [&](const Rgb& value, const Vec3f& point) {
    if (point.cwiseAbs().maxCoeff() > 3.9f) return;
    const Vec3f to_eye = (Vec3f(0, 9, 3) - point).normalized();
    if (std::abs(miss(point, to_eye, centre)) < 0.55f) return;
    const float from_ball = miss(point, to_light, centre);
    const float up_at_wall = (point.z() + 4) / 0.5f * to_light.y();
    if (up_at_wall < 2.1f)
      return;  // maps reach as far as the objects: a support's shadow on another is not drawn there
    if (from_ball < 0.45f) {
      ++behind_ball;
      EXPECT_EQ(value.maxCoeff(), 0) << point.transpose();
    } else if (from_ball > 0.55f) {
      ++lit;
      expect_near(value, kWhite * kLux / kPiF * to_light.y(), 1e-3f);
    }
  });
  EXPECT_GT(behind_ball, 20);
  EXPECT_GT(lit, 2000);
  EXPECT_GT(rgb(p, kWidth / 2, kHeight / 2 - 6)[0], 50);  // the ball itself
}

// Maps are compared with the plane of the triangle, not with what a normal map makes of it.
TEST_F(Shadows, ANormalMapMakesNoShadowOnItsOwnSurface) {
  Scene scene;
  add_ground(scene, lambertian(kWhite));
  Material bent = lambertian(kWhite);
  bent.normal_texture.texture = 0;
  add_box(scene, {-1, 0, -1}, {1, 0.5f, 1}, bent);
  for (Vertex& vertex : scene.vertices) vertex.uv = {vertex.position.x(), vertex.position.z()};
  render::TextureImage map;
  map.width = map.height = 1;
  map.rgba = {218, 128, 218, 255};  // 45° to one side
  scene.textures.push_back(map);
  const SceneCamera camera = camera_at({0, 5, 0}, {0, 0, 0}, 0.3f);
  const auto p = picture(scene, light_set({{Vec3f(0, 1, 0.02f), kLux}}), camera, kWidth, kHeight, 1, 128);
  float most = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) most = std::max(most, rgb(p, x, y)[0]);
  EXPECT_NEAR(most, 0.5f * 1000 / kPiF * std::sqrt(0.5f), 3);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) EXPECT_GT(rgb(p, x, y)[0], 0.98f * most) << x << ", " << y;
}

TEST_F(Shadows, OfSimplifiedCastersAreThoseOfTheFullMeshes) {
  Scene scene;
  add_ground(scene, lambertian(kWhite));
  add_sphere(scene, {-1, 0.5f, 0}, 0.5f, lambertian(kWhite));
  add_lattice(scene, 0.012f);
  std::vector<std::pair<Vec3f, Rgb>> lights;
  for (int i = 0; i < 9; ++i)
    lights.emplace_back(Vec3f(static_cast<float>(i - 4) * 0.4f, 1, 0.8f - 0.3f * static_cast<float>(i % 4)),
                        kLux);
  const SceneCamera camera = camera_at({0, 4, 4}, {0, 0.3f, 0}, 0.7f);
  const auto full = picture(scene, light_set(lights), camera, kWidth, kHeight, 1, 256, false);
  const auto fewer = picture(scene, light_set(lights), camera, kWidth, kHeight, 1, 256, true);
  double difference = 0;
  double total = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      EXPECT_EQ(alpha(fewer, x, y), alpha(full, x, y));  // what is seen is not simplified
      difference += static_cast<double>((rgb(fewer, x, y) - rgb(full, x, y)).square().sum());
      total += static_cast<double>(rgb(full, x, y).square().sum());
    }
  const double relative_rmse = std::sqrt(difference / total);
  // Edges of shadows move by at most a quarter of a texel of a light's map, so a pixel there changes by at most
  // half of one light of nine; a tenth of the pixels are at an edge: 1/18 · √0.1.
  EXPECT_LT(relative_rmse, 0.0176);
  EXPECT_GT(relative_rmse, 0);  // simplified indeed
}

// Simpler facets of a hollow lie above it; they must not shadow what they stand for.
TEST_F(Shadows, AnOpenBowlHasNoShadowOnItsInsideFromSimplerCasters) {
  constexpr int kRings = 48, kSectors = 96;
  std::vector<Vec3f> positions, normals;
  std::vector<std::uint32_t> indices;
  for (int r = 0; r <= kRings; ++r)
    for (int s = 0; s < kSectors; ++s) {
      const double theta = kPi / 3 * r / kRings, phi = 2 * kPi * s / kSectors;
      const Vec3d down(std::sin(theta) * std::cos(phi), -std::cos(theta), std::sin(theta) * std::sin(phi));
      positions.push_back((down + Vec3d(0, 1, 0)).cast<float>());
      normals.push_back((-down).cast<float>());
    }
  const auto at = [](int r, int s) { return static_cast<std::uint32_t>(r * kSectors + s % kSectors); };
  for (int r = 0; r < kRings; ++r)
    for (int s = 0; s < kSectors; ++s)
      for (const std::uint32_t i :
           {at(r, s), at(r, s + 1), at(r + 1, s + 1), at(r, s), at(r + 1, s + 1), at(r + 1, s)})
        indices.push_back(i);
  Scene scene;
  add_mesh(scene, positions, normals, indices, lambertian(kWhite));
  const SceneCamera camera = camera_at({0, 6, 0.01f}, {0, 0, 0}, 0.3f);
  for (const int map_size : {32, 64, 256}) {
    const auto p =
        picture(scene, light_set({{Vec3f::UnitY(), kLux}}), camera, kWidth, kHeight, 1, map_size, true);
    const auto full =
        picture(scene, light_set({{Vec3f::UnitY(), kLux}}), camera, kWidth, kHeight, 1, map_size, false);
    int inside = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        if (alpha(full, x, y) < 1) continue;
        ++inside;
        EXPECT_GT(rgb(p, x, y)[0], 0.99f * rgb(full, x, y)[0]) << map_size << " at " << x << ", " << y;
      }
    EXPECT_GT(inside, 1000);
  }
}

TEST_F(Shadows, LightsBeyondOneAtlasOrBlockHaveTheirShadowsToo) {
  // 600 equal lights in one direction are one light 600 times as strong.
  Scene scene;
  add_ground(scene, lambertian(kWhite));
  add_sphere(scene, {0, 0.8f, 0}, 0.5f, lambertian(kWhite));
  const SceneCamera camera = camera_at({0, 9, 0.01f}, {0, 0, 0}, 0.7f);
  const Vec3f light(1, 1, 0.3f);
  const auto one = picture(scene, light_set({{light, kLux}}), camera, 80, 60, 1, 64);
  const auto many =
      picture(scene, light_set(std::vector(600, std::pair(light, Rgb(kLux / 600)))), camera, 80, 60, 1, 64);
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 80; ++x) EXPECT_NEAR(rgb(many, x, y)[0], rgb(one, x, y)[0], 1e-4f * 1000);
}

TEST_F(Shadows, LargerMapsThanTheAtlasHoldsAtOnceGiveTheSamePicture) {
  // 2048² maps: four an atlas, so nine lights take three of them.
  Scene scene;
  add_ground(scene, lambertian(kWhite));
  add_box(scene, {-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}, lambertian(kWhite));
  const SceneCamera camera = camera_at({0, 9, 0.01f}, {0, 0, 0}, 0.7f);
  std::vector<std::pair<Vec3f, Rgb>> lights;
  Rgb sum = Rgb::Zero();
  for (int i = 0; i < 9; ++i) lights.emplace_back(Vec3f(static_cast<float>(i - 4) * 0.2f, 1, 0.1f), kLux);
  const auto all = picture(scene, light_set(lights), camera, 40, 30, 1, 2048);
  for (const auto& light : lights)
    sum += rgb(picture(scene, light_set({light}), camera, 40, 30, 1, 2048), 25, 14);
  expect_near(rgb(all, 25, 14), sum, 1e-5f);
}

}  // namespace
}  // namespace lightwell
