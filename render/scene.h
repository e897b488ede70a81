// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "lighting/vector.h"

namespace lightwell::render {

using Vec2f = Eigen::Vector2f;
using Mat4f = Eigen::Matrix4f;

// World space: node transforms are applied when a scene is read.
struct Vertex {
  Vec3f position = Vec3f::Zero();
  Vec3f normal = Vec3f::UnitY();
  Vec2f uv = Vec2f::Zero();
};

// Either the normalised Phong model of extras.phong, f = diffuse/π + specular (n+2)/(2π) max(0, R·L)ⁿ
// (Lambertian where specular is 0), or glTF's metallic–roughness.
struct Material {
  enum class Model { metallic_roughness, phong } model = Model::metallic_roughness;
  Rgb base_color = Rgb::Constant(1);  // Phong: diffuse
  float metallic = 1;
  float roughness = 1;
  Rgb specular = Rgb::Zero();
  float exponent = 1;
  int base_color_texture = -1;          // index into Scene::textures
  int metallic_roughness_texture = -1;  // green: roughness, blue: metallic
  bool double_sided = false;
};

struct Primitive {
  std::uint32_t first_index = 0;
  std::uint32_t index_count = 0;
  int material = 0;
  bool casts_shadow = true;
};

// 8 bit RGBA, row 0 is v = 0.
struct TextureImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;
};

// Perspective, as glTF has it: looks along −Z, +Y up.
struct SceneCamera {
  std::string name;
  std::string node_name;
  Mat4f world_from_camera = Mat4f::Identity();
  float yfov_rad = 0.7f;
  float aspect = 0;  // width / height; 0: the picture's
  float near_m = 0.1f;
  float far_m = std::numeric_limits<float>::infinity();
};

struct Scene {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;  // counter-clockwise triangles
  std::vector<Primitive> primitives;
  std::vector<Material> materials;
  std::vector<TextureImage> textures;
  std::vector<SceneCamera> cameras;
  std::size_t dropped_triangles = 0;  // of no area
  std::vector<std::string>
      left_out;  // primitives that are not triangles: "mesh 0 primitive 2: mode 1 (lines)"

  [[nodiscard]] std::size_t triangles() const { return indices.size() / 3; }
};

}  // namespace lightwell::render
