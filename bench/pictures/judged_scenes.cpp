// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/pictures/judged_scenes.h"

#include <cmath>

#include "bench/pictures/judged_lights.h"
#include "render/scene_writer.h"

namespace lightwell::pictures {
namespace {

using render::add_bar;
using render::add_box;
using render::add_capsule;
using render::camera_at;
using render::Mesh;
using render::phong_material;
using render::SceneWriter;

render::Material matte(const Rgb& albedo) {
  return phong_material(albedo, Rgb::Zero(), 1);
}

SceneWriter on_ground() {
  SceneWriter writer;
  writer.add("ground", render::ground_mesh(6), "ground", matte({0.42f, 0.40f, 0.38f}), false);
  return writer;
}

std::string poles_gltf() {
  SceneWriter writer = on_ground();
  writer.add("ball", render::sphere_mesh({-0.75f, 0.4f, 0.35f}, 0.4f, 40, 64), "chalk",
             matte(Rgb::Constant(0.7f)));
  writer.add("torus", render::torus_mesh({0.55f, 0.45f, 0.25f}, {0.3f, 1, 0.5f}, 0.32f, 0.11f, 80, 32),
             "clay", matte({0.6f, 0.35f, 0.22f}));
  Mesh poles;
  for (const auto& [x, z] : std::initializer_list<std::pair<float, float>>{{-2.2f, -1.2f},
                                                                           {-1.5f, -0.4f},
                                                                           {-0.9f, -1.5f},
                                                                           {-0.1f, -0.7f},
                                                                           {0.6f, -1.4f},
                                                                           {1.3f, -0.5f},
                                                                           {2.1f, -1.1f},
                                                                           {-0.2f, 1.0f},
                                                                           {1.0f, 1.1f}})
    add_bar(poles, {x, 0, z}, {x, 1.3f, z}, 0.012f, 12);
  writer.add("poles", poles, "paint", matte({0.25f, 0.4f, 0.5f}));
  return writer.gltf(camera_at("poles", {0.4f, 1.7f, 3.9f}, {0, 0.35f, 0}, 0.58f));
}

std::string figure_gltf() {
  SceneWriter writer = on_ground();
  Mesh body;
  const auto limb = [&](std::initializer_list<Vec3f> joints, float radius) {
    for (const Vec3f* p = joints.begin(); p + 1 != joints.end(); ++p)
      add_capsule(body, p[0], p[1], radius, 8, 24);
  };
  limb({{0, 1.0f, 0}, {0.02f, 1.35f, 0.02f}}, 0.16f);                                 // trunk
  limb({{0.02f, 1.5f, 0.02f}, {0.04f, 1.58f, 0.05f}}, 0.055f);                        // neck
  limb({{0.05f, 1.68f, 0.06f}, {0.06f, 1.75f, 0.06f}}, 0.105f);                       // head
  limb({{-0.1f, 0.9f, 0}, {-0.16f, 0.48f, 0.1f}, {-0.2f, 0.09f, -0.05f}}, 0.07f);     // right leg
  limb({{-0.2f, 0.06f, -0.05f}, {-0.23f, 0.06f, 0.13f}}, 0.055f);                     // foot
  limb({{0.1f, 0.9f, 0}, {0.2f, 0.5f, 0.22f}, {0.24f, 0.09f, 0.12f}}, 0.07f);         // left leg
  limb({{0.24f, 0.06f, 0.12f}, {0.28f, 0.06f, 0.3f}}, 0.055f);                        // foot
  limb({{-0.17f, 1.4f, 0.02f}, {-0.42f, 1.25f, 0.12f}, {-0.5f, 1.5f, 0.3f}}, 0.05f);  // arm, raised
  limb({{0.2f, 1.4f, 0.02f}, {0.36f, 1.14f, -0.06f}, {0.24f, 0.98f, 0.14f}}, 0.05f);  // hand on hip
  writer.add("figure", body, "plaster", matte({0.62f, 0.55f, 0.48f}));
  return writer.gltf(camera_at("figure", {0.9f, 1.7f, 3.6f}, {0, 0.8f, 0}, 0.62f));
}

std::string phong_gltf() {
  SceneWriter writer = on_ground();
  float x = -0.85f;
  for (const float exponent : {8.0f, 40.0f, 200.0f}) {
    const std::string name = "ball " + std::to_string(static_cast<int>(exponent));
    writer.add(name, render::sphere_mesh({x, 0.38f, 0}, 0.38f, 40, 64), name,
               phong_material({0.15f, 0.11f, 0.09f}, Rgb::Constant(0.6f), exponent));
    x += 0.85f;
  }
  return writer.gltf(camera_at("phong", {0.2f, 1.4f, 3.6f}, {0, 0.3f, 0}, 0.58f));
}

std::string box_gltf() {
  SceneWriter writer = on_ground();
  Mesh box;  // five slabs that touch without overlapping
  add_box(box, {-0.7f, 0, -0.6f}, {0.7f, 0.05f, 0.6f});
  add_box(box, {-0.7f, 0.05f, -0.6f}, {-0.65f, 0.9f, 0.6f});
  add_box(box, {0.65f, 0.05f, -0.6f}, {0.7f, 0.9f, 0.6f});
  add_box(box, {-0.65f, 0.05f, -0.6f}, {0.65f, 0.9f, -0.55f});
  add_box(box, {-0.65f, 0.05f, 0.55f}, {0.65f, 0.9f, 0.6f});
  writer.add("box", box, "card", matte({0.6f, 0.5f, 0.38f}));
  writer.add("knot", render::knot_mesh({0.05f, 0.46f, 0}, 0.1f, 0.055f, 200, 20), "clay",
             matte({0.35f, 0.5f, 0.6f}));
  return writer.gltf(camera_at("box", {0.7f, 3.0f, 1.9f}, {0, 0.4f, 0}, 0.5f));
}

}  // namespace

const std::vector<JudgedScene>& judged_scenes() {
  static const std::vector<JudgedScene> all = {{"poles", poles_gltf, sun_light},
                                               {"figure", figure_gltf, night_light},
                                               {"phong", phong_gltf, window_light},
                                               {"box", box_gltf, overcast_light}};
  return all;
}

}  // namespace lightwell::pictures
