// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/casters.h"

#include <gtest/gtest.h>

#include <random>

#include "render/light_rows.h"
#include "tests/support/test_scene.h"

namespace lightwell::render {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

TEST(Casters, ClosedMeshesAreToldFromOpenOnes) {
  Scene scene;
  add_sphere(scene, {0, 1, 0}, 0.5f, lambertian(Rgb::Ones()), true, 10);
  add_box(scene, {0, 0, 0}, {1, 1, 1}, lambertian(Rgb::Ones()));
  const Casters closed = find_casters(scene);
  EXPECT_EQ(closed.closed_count, scene.indices.size());
  scene.primitives[1].index_count -= 3;  // a hole in the box
  const Casters holed = find_casters(scene);
  EXPECT_EQ(holed.open_count, 33u);
}

TEST(Casters, WeldingLeavesOneVertexAPosition) {
  Scene scene;
  add_box(scene, {0, 0, 0}, {1, 1, 1}, lambertian(Rgb::Ones()));
  EXPECT_EQ(find_casters(scene).positions.size(), 8u);
}

TEST(Casters, NothingThatCastsIsEmpty) {
  Scene scene;
  add_ground(scene, lambertian(Rgb::Ones()), false);
  const Casters casters = find_casters(scene);
  EXPECT_TRUE(casters.indices.empty());
  EXPECT_EQ(casters.objects.radius, 0);
}

TEST(Casters, ASupportHasEverythingOnItsFront) {
  Scene scene;
  add_ground(scene, lambertian(Rgb::Ones()), true);
  add_box(scene, {0, 0, 0}, {1, 1, 1}, lambertian(Rgb::Ones()));
  EXPECT_TRUE(find_casters(scene).is_support[0]);
  add_box(scene, {0, -2, 0}, {1, -1, 1}, lambertian(Rgb::Ones()));  // below the ground
  EXPECT_FALSE(find_casters(scene).is_support[0]);
}

TEST(BoundingSphere, ContainsEveryPointAndIsNearTheSmallest) {
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  std::vector<Vec3f> points;
  for (int i = 0; i < 500; ++i)
    points.emplace_back(Vec3f(3, -2, 1) +
                        2 * Vec3f(normal(random), normal(random), normal(random)).normalized());
  const Sphere sphere = bounding_sphere(points);
  for (const Vec3f& p : points) EXPECT_LE((p - sphere.centre).norm(), sphere.radius);
  EXPECT_LT(sphere.radius, 2 * 1.01f);
  EXPECT_GT(bounding_sphere(std::vector<Vec3f>{{1, 2, 3}}).radius, 0);
  EXPECT_EQ(bounding_sphere({}).radius, 0);
}

TEST(LightRows, MapEveryCasterIntoTheUnitCubeAndDepthAwayFromTheLight) {
  Scene scene;
  add_box(scene, {-1, 0, 2}, {1, 3, 2.5f}, lambertian(Rgb::Ones()));
  const Casters casters = find_casters(scene);
  for (const Vec3f& d : {Vec3f(0, 1, 0), Vec3f(0, -1, 0), Vec3f(1, 0.2f, -3)}) {
    const LightSet lights = light_set({{d, Rgb::Ones()}});
    const auto rows = make_light_rows(lights.lights, casters, 64);
    ASSERT_EQ(rows.size(), 1u);
    const auto place = [&](const float(&row)[4], const Vec3f& p) {
      return row[0] * p.x() + row[1] * p.y() + row[2] * p.z() + row[3];
    };
    for (const Vec3f& p : casters.positions) {
      for (const float s : {place(rows[0].u, p), place(rows[0].v, p)}) {
        EXPECT_GE(s, 1.0f / 64);
        EXPECT_LE(s, 63.0f / 64);
      }
      EXPECT_GE(place(rows[0].w, p), 0);
      EXPECT_LT(place(rows[0].w, p), 1);
      EXPECT_GT(place(rows[0].w, p), place(rows[0].w, p + d.normalized()));
    }
  }
}

TEST(LightRows, LightsWithoutPowerTakeNoMap) {
  const LightSet lights = light_set({{Vec3f::UnitY(), Rgb::Zero()}, {Vec3f::UnitX(), Rgb(0, 0, 1)}});
  EXPECT_EQ(make_light_rows(lights.lights, Casters{}, 64).size(), 1u);
}

}  // namespace
}  // namespace lightwell::render
