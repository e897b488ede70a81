// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/stage.h"

#include <Eigen/Geometry>

#include "render/scene_writer.h"

namespace lightwell::render {
namespace {

Mesh railing() {
  Mesh m;
  constexpr int kPoles = 10;
  for (int i = 0; i < kPoles; ++i) {
    const float x = -1.35f + 0.3f * static_cast<float>(i);
    add_bar(m, {x, 0, -0.95f}, {x, 0.9f, -0.95f}, 0.015f, 12);
  }
  for (const float y : {0.2f, 0.4f, 0.6f, 0.8f})
    add_bar(m, {-1.5f, y, -0.95f}, {1.5f, y, -0.95f}, 0.011f, 12);
  return m;
}

}  // namespace

std::string stage_gltf() {
  SceneWriter writer;
  writer.add("ground", ground_mesh(6), "matte", phong_material({0.42f, 0.40f, 0.38f}, Rgb::Zero(), 1), false);
  writer.add("pearl", sphere_mesh({-0.85f, 0.45f, 0.35f}, 0.45f, 44, 48), "pearl",
             phong_material(Rgb::Constant(0.6f), Rgb::Constant(0.22f), 60));
  Mesh pedestal;
  add_bar(pedestal, {0.55f, 0, 0}, {0.55f, 0.35f, 0}, 0.42f, 48);
  writer.add("pedestal", pedestal, "stone", phong_material({0.55f, 0.52f, 0.47f}, Rgb::Zero(), 1));
  writer.add("knot", knot_mesh({0.55f, 0.98f, 0}, 0.18f, 0.085f, 280, 20), "bronze",
             phong_material({0.35f, 0.16f, 0.06f}, {0.40f, 0.28f, 0.16f}, 24));
  writer.add("railing", railing(), "lacquer",
             phong_material({0.10f, 0.22f, 0.30f}, Rgb::Constant(0.05f), 30));
  // Slightly down at the group.
  SceneCamera camera;
  camera.name = "stage";
  camera.node_name = "stage camera";
  camera.yfov_rad = 0.58f;
  camera.far_m = 50;
  camera.world_from_camera.topLeftCorner<3, 3>() =
      Eigen::AngleAxisf(-0.26f, Vec3f::UnitX()).toRotationMatrix();
  camera.world_from_camera.col(3).head<3>() = Vec3f(0, 1.75f, 4.6f);
  return writer.gltf(camera);
}

}  // namespace lightwell::render
