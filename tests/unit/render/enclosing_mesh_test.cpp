// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/enclosing_mesh.h"

#include <gtest/gtest.h>

#include <utility>

#include "tests/support/test_scene.h"

namespace lightwell {
namespace {

using render::enclosing_mesh;
using render::Scene;
using test::lambertian;

TEST(EnclosingMesh, HasThePointInsideAndIsNoFloorAndNoRoom) {
  Scene scene;
  test::add_ground(scene, lambertian(Rgb::Ones()), true);
  test::add_box(scene, {-1, 0, -1}, {1, 2, 1}, lambertian(Rgb::Ones()));
  test::add_sphere(scene, {3, 1, 0}, 0.5f, lambertian(Rgb::Ones()), true, 10);
  EXPECT_EQ(enclosing_mesh(scene, {0.2, 0.5, -0.3}), 1u);
  EXPECT_EQ(enclosing_mesh(scene, {3.1, 1.2, 0}), 2u);
  EXPECT_EQ(enclosing_mesh(scene, {0, 2.1, 0}), std::nullopt);   // above
  EXPECT_EQ(enclosing_mesh(scene, {0, -0.1, 0}), std::nullopt);  // below the floor
  EXPECT_EQ(enclosing_mesh(scene, {1.5, 1, 0}), std::nullopt);   // between

  // The same box as a room: its walls face inward.
  Scene room = scene;
  const auto& walls = room.primitives[1];
  for (std::uint32_t i = walls.first_index; i < walls.first_index + walls.index_count; i += 3)
    std::swap(room.indices[i], room.indices[i + 1]);
  EXPECT_EQ(enclosing_mesh(room, {0.2, 0.5, -0.3}), std::nullopt);

  // What casts nothing, or has holes, hides no lamp.
  scene.primitives[1].casts_shadow = false;
  EXPECT_EQ(enclosing_mesh(scene, {0.2, 0.5, -0.3}), std::nullopt);
  scene.primitives[1].casts_shadow = true;
  scene.materials[1].alpha_cutoff = 0.5f;
  EXPECT_EQ(enclosing_mesh(scene, {0.2, 0.5, -0.3}), std::nullopt);
}

}  // namespace
}  // namespace lightwell
