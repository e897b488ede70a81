// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "lighting/vector.h"
#include "render/rig.h"

namespace lightwell::render {

using Vec2f = Eigen::Vector2f;

// World space: nodes, skins and morph targets are applied.
struct Vertex {
  Vec3f position = Vec3f::Zero();
  Vec3f normal = Vec3f::UnitY();
  Vec2f uv = Vec2f::Zero();
  std::array<std::uint16_t, 4> color = {65535, 65535, 65535, 65535};  // linear, of 65535
};

// Index into Scene::textures, and where the vertices' uv come to in it: scale, turn and shift.
struct TextureUse {
  int texture = -1;
  std::array<float, 6> from_uv = {1, 0, 0, 0, 1, 0};  // two rows: u' = a u + b v + c

  [[nodiscard]] explicit operator bool() const { return texture >= 0; }
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
  TextureUse base_color_texture;
  TextureUse metallic_roughness_texture;  // green: roughness, blue: metallic
  TextureUse normal_texture;
  float normal_scale = 1;
  Rgb emission = Rgb::Zero();  // radiance, cd/m²
  TextureUse emission_texture;
  // Nothing is there where base colour's alpha, times this and the vertex's, is below the cutoff.
  float alpha = 1;
  float alpha_cutoff = 0;
  bool double_sided = false;
};

struct Primitive {
  std::uint32_t first_index = 0;
  std::uint32_t index_count = 0;
  int material = 0;
  bool casts_shadow = true;
  bool moves = false;              // its vertices change with time
  bool turns_inside_out = false;   // at times: both sides of its triangles are seen
  std::uint32_t first_vertex = 0;  // its own vertices; known where it moves
  std::uint32_t vertex_count = 0;
};

// 8 bit RGBA, row 0 is v = 0.
struct TextureImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;
  // As OpenGL numbers them: GL_REPEAT, GL_LINEAR_MIPMAP_LINEAR, GL_LINEAR.
  int wrap_u = 0x2901;
  int wrap_v = 0x2901;
  int min_filter = 0x2703;
  int mag_filter = 0x2601;
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
  std::vector<std::string> remarks;  // what else is not shown as the file says, a sentence each
  Rig rig;

  [[nodiscard]] std::size_t triangles() const { return indices.size() / 3; }
};

}  // namespace lightwell::render
