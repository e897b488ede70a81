// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/scene.h"

// Scenes that are made by program: the demo stage and those that pictures are judged by.
namespace lightwell::render {

// Triangles in the making, counter-clockwise seen from outside. Metres.
struct Mesh {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;
  std::vector<std::uint32_t> indices;

  std::uint32_t add(const Vec3f& position, const Vec3f& normal);
  void quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d);
};

// Square on the plane y = 0, facing up.
Mesh ground_mesh(float half_side);
// 2 · sectors · (rings − 1) triangles, poles along y.
Mesh sphere_mesh(const Vec3f& centre, float radius, int rings, int sectors);
// Adds a closed cylinder from one point to another, with flat ends.
void add_bar(Mesh& mesh, const Vec3f& from, const Vec3f& to, float radius, int sides);
// Adds a closed cylinder with half spheres on its ends, rings of triangles on each.
void add_capsule(Mesh& mesh, const Vec3f& from, const Vec3f& to, float radius, int rings, int sides);
// Adds a closed box of 12 triangles with flat sides.
void add_box(Mesh& mesh, const Vec3f& low, const Vec3f& high);
// A ring around the axis; radius: of the tube's middle.
Mesh torus_mesh(const Vec3f& centre, const Vec3f& axis, float radius, float tube, int steps, int sides);
// A tube along the (2,3) torus knot, standing upright.
Mesh knot_mesh(const Vec3f& centre, float size, float tube, int steps, int sides);

Material phong_material(const Rgb& diffuse, const Rgb& specular, float exponent);

// Looks from eye to target, +Y up; not straight up or down.
SceneCamera camera_at(const std::string& name, const Vec3f& eye, const Vec3f& target, float yfov_rad);

// Collects meshes into one glTF 2.0 text with its data inside.
class SceneWriter {
 public:
  // material: without textures. extras.phong is written where it is Phong, and for other viewers its diffuse
  // colour.
  void add(const std::string& name, Mesh mesh, const std::string& material_name, const Material& material,
           bool casts_shadow = true);
  [[nodiscard]] std::string gltf(const SceneCamera& camera) const;

 private:
  struct Part {
    std::string name;
    Mesh mesh;
    std::string material_name;
    Material material;
    bool casts_shadow = true;
  };
  std::vector<Part> parts_;
};

}  // namespace lightwell::render
