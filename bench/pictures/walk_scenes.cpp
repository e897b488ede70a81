// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/pictures/walk_scenes.h"

#include "render/scene_writer.h"

namespace lightwell::pictures {
namespace {

constexpr float kHalf_m = 0.8f;  // of the ground that is walked over

render::SceneWriter on_ground() {
  render::SceneWriter writer;
  writer.add("ground", render::ground_mesh(kHalf_m), "ground",
             render::phong_material(Rgb::Constant(0.6f), Rgb::Zero(), 1), false);
  return writer;
}

}  // namespace

std::string walk_ground_gltf() {
  return on_ground().gltf(render::camera_at("above", {0, 2.6f, 0.02f}, Vec3f::Zero(), 0.62f));
}

std::string walk_set_gltf() {
  render::SceneWriter writer = on_ground();
  writer.add("ball", render::sphere_mesh({-0.1f, 0.12f, 0.3f}, 0.12f, 40, 64), "chalk",
             render::phong_material(Rgb::Constant(0.7f), Rgb::Zero(), 1));
  writer.add("knot", render::knot_mesh({0.42f, 0.17f, 0.36f}, 0.06f, 0.026f, 240, 20), "glaze",
             render::phong_material({0.3f, 0.32f, 0.36f}, Rgb::Constant(0.3f), 6));
  render::Mesh poles;
  for (const float x : {0.05f, 0.25f, 0.45f})
    render::add_bar(poles, {x, 0, -0.35f}, {x, 0.3f, -0.35f}, 0.02f, 32);
  writer.add("poles", poles, "paint", render::phong_material(Rgb::Constant(0.6f), Rgb::Zero(), 1));
  render::Mesh block;
  render::add_box(block, {-0.62f, 0, 0.12f}, {-0.38f, 0.16f, 0.3f});
  writer.add("block", block, "clay", render::phong_material({0.6f, 0.45f, 0.35f}, Rgb::Zero(), 1));
  return writer.gltf(render::camera_at("front", {0, 1.25f, 1.75f}, {0, 0, 0.03f}, 0.62f));
}

}  // namespace lightwell::pictures
