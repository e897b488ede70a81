// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <utility>
#include <vector>

#include "lighting/light_set.h"
#include "render/camera.h"
#include "render/scene.h"

// Scenes whose picture is known in closed form.
namespace lightwell::test {

using render::Material;
using render::Scene;
using render::SceneCamera;
using render::Vertex;

inline Material lambertian(const Rgb& albedo) {
  Material m;
  m.model = Material::Model::phong;
  m.base_color = albedo;
  return m;
}

// Triangles (corner indices into positions) become a primitive; normals empty: flat ones.
inline void add_mesh(Scene& scene, const std::vector<Vec3f>& positions, const std::vector<Vec3f>& normals,
                     const std::vector<std::uint32_t>& triangles, const Material& material,
                     bool casts = true) {
  render::Primitive p;
  p.first_index = static_cast<std::uint32_t>(scene.indices.size());
  p.index_count = static_cast<std::uint32_t>(triangles.size());
  p.material = static_cast<int>(scene.materials.size());
  p.casts_shadow = casts;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::size_t t = i - i % 3;
    const Vec3f a = positions[triangles[t]];
    const Vec3f flat = (positions[triangles[t + 1]] - a).cross(positions[triangles[t + 2]] - a).normalized();
    scene.indices.push_back(static_cast<std::uint32_t>(scene.vertices.size()));
    scene.vertices.push_back(
        {positions[triangles[i]], normals.empty() ? flat : normals[triangles[i]], render::Vec2f::Zero()});
  }
  scene.materials.push_back(material);
  scene.primitives.push_back(p);
}

// Square on the plane y = height, facing up.
inline void add_ground(Scene& scene, const Material& material, bool casts = false, float half_side = 5,
                       float height = 0) {
  add_mesh(scene,
           {{-half_side, height, -half_side},
            {-half_side, height, half_side},
            {half_side, height, half_side},
            {half_side, height, -half_side}},
           {}, {0, 1, 2, 0, 2, 3}, material, casts);
}

inline void add_box(Scene& scene, const Vec3f& low, const Vec3f& high, const Material& material,
                    bool casts = true) {
  std::vector<Vec3f> corners;
  for (int i = 0; i < 8; ++i)
    corners.emplace_back((i & 1) != 0 ? high.x() : low.x(), (i & 2) != 0 ? high.y() : low.y(),
                         (i & 4) != 0 ? high.z() : low.z());
  add_mesh(scene, corners, {}, {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                                2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6},
           material, casts);
}

inline void add_sphere(Scene& scene, const Vec3f& centre, float radius, const Material& material,
                       bool casts = true, std::uint32_t rings = 60) {
  const std::uint32_t sectors = 2 * rings;
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t r = 0; r <= rings; ++r)
    for (std::uint32_t s = 0; s < sectors; ++s) {
      const double theta = kPi * r / rings;
      const double lambda = 2 * kPi * s / sectors;
      const double sine = r % rings == 0 ? 0 : std::sin(theta);  // one pole, exactly
      const Vec3f n = Vec3d(sine * std::sin(lambda), std::cos(theta), sine * std::cos(lambda)).cast<float>();
      positions.push_back(centre + radius * n);
      normals.push_back(n);
    }
  for (std::uint32_t r = 0; r < rings; ++r)
    for (std::uint32_t s = 0; s < sectors; ++s) {
      const std::uint32_t a = r * sectors + s;
      const std::uint32_t b = r * sectors + (s + 1) % sectors;
      if (r > 0) triangles.insert(triangles.end(), {a, b + sectors, b});
      if (r + 1 < rings) triangles.insert(triangles.end(), {a, a + sectors, b + sectors});
    }
  add_mesh(scene, positions, normals, triangles, material, casts);
}

// Closed bar of 16 sides along an axis (0 x, 1 y, 2 z), from its lower end on.
inline void add_bar(Scene& scene, const Vec3f& from, int axis, float length, float radius,
                    const Material& material) {
  constexpr std::uint32_t kSides = 16;
  constexpr std::uint32_t kRings = 5;
  const Vec3f along = Vec3f::Unit(axis);
  const Vec3f u = Vec3f::Unit((axis + 1) % 3);
  const Vec3f v = Vec3f::Unit((axis + 2) % 3);
  std::vector<Vec3f> positions;
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t r = 0; r < kRings; ++r)
    for (std::uint32_t s = 0; s < kSides; ++s) {
      const auto angle = static_cast<float>(2 * kPi * s / kSides);
      positions.push_back(from + along * (length * static_cast<float>(r) / (kRings - 1)) +
                          radius * (std::cos(angle) * u + std::sin(angle) * v));
    }
  positions.push_back(from);
  positions.push_back(from + length * along);
  const std::uint32_t bottom = kRings * kSides;
  for (std::uint32_t s = 0; s < kSides; ++s) {
    const std::uint32_t next = (s + 1) % kSides;
    for (std::uint32_t r = 0; r + 1 < kRings; ++r) {
      const std::uint32_t a = r * kSides + s;
      const std::uint32_t b = r * kSides + next;
      triangles.insert(triangles.end(), {a, b, b + kSides, a, b + kSides, a + kSides});
    }
    const std::uint32_t top = (kRings - 1) * kSides;
    triangles.insert(triangles.end(), {bottom, next, s, bottom + 1, top + s, top + next});
  }
  add_mesh(scene, positions, {}, triangles, material);
}

// Five bars along x and five along y, crossing without touching. Returns how many.
inline std::size_t add_lattice(Scene& scene, float radius) {
  for (int i = 0; i < 5; ++i) {
    const float at = 0.2f + 0.2f * static_cast<float>(i);
    add_bar(scene, {-0.6f, at, 0}, 0, 1.2f, radius, lambertian(Rgb::Constant(0.5f)));
    add_bar(scene, {at - 0.6f, 0.1f, 0.1f}, 1, 1.2f, radius, lambertian(Rgb::Constant(0.5f)));
  }
  return 10;
}

inline SceneCamera camera_at(const Vec3f& eye, const Vec3f& target, float yfov_rad = 0.6f) {
  SceneCamera camera;
  camera.yfov_rad = yfov_rad;
  const Vec3f back = (eye - target).normalized();
  // Looking straight down, the top of the picture is −Z.
  const Vec3f up = std::abs(back.y()) > 0.999f ? Vec3f(-Vec3f::UnitZ()) : Vec3f(Vec3f::UnitY());
  camera.world_from_camera.col(0).head<3>() = up.cross(back).normalized();
  camera.world_from_camera.col(1).head<3>() = back.cross(camera.world_from_camera.col(0).head<3>());
  camera.world_from_camera.col(2).head<3>() = back;
  camera.world_from_camera.col(3).head<3>() = eye;
  return camera;
}

inline LightSet light_set(const std::vector<std::pair<Vec3f, Rgb>>& lights) {
  LightSet set;
  for (const auto& [direction, illuminance] : lights) {
    DirectionalLight light;
    light.direction = direction.normalized();
    light.illuminance = illuminance;
    set.total_illuminance += illuminance;
    set.lights.push_back(light);
  }
  return set;
}

// Direction through the centre of pixel (x, y), row 0 at the top; any length.
inline Vec3f pixel_ray(const render::View& view, int x, int y, int width, int height) {
  const float nx = 2 * (static_cast<float>(x) + 0.5f) / static_cast<float>(width) - 1;
  const float ny = 1 - 2 * (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
  return view.forward + nx * view.right + ny * view.up;
}

}  // namespace lightwell::test
