// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/casters.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "render/caster_mesh.h"

namespace lightwell::render {
namespace {

using Index = std::uint32_t;

class Welder {
 public:
  Index operator()(const Vec3f& p) {
    // +0 and −0 are one place.
    const std::array<float, 3> key = {p.x() + 0.0f, p.y() + 0.0f, p.z() + 0.0f};
    const auto [place, is_new] = known_.try_emplace(key, static_cast<Index>(positions.size()));
    if (is_new) positions.push_back(p);
    return place->second;
  }
  std::vector<Vec3f> positions;

 private:
  std::map<std::array<float, 3>, Index> known_;
};

// The front-facing normal where the triangles lie in one plane, facing one way, with the scene at or above
// it.
std::optional<Vec3f> support_normal(std::span<const Index> triangles, const std::vector<Vec3f>& positions,
                                    float tolerance, const Scene& scene) {
  const auto normal_of = [&](std::size_t t) {
    const Vec3f& a = positions[triangles[t]];
    return Vec3f((positions[triangles[t + 1]] - a).cross(positions[triangles[t + 2]] - a).normalized());
  };
  if (triangles.empty()) return std::nullopt;
  const Vec3f n = normal_of(0);
  const float height = n.dot(positions[triangles[0]]);
  for (const Index i : triangles)
    if (std::abs(n.dot(positions[i]) - height) > tolerance) return std::nullopt;
  for (std::size_t t = 0; t < triangles.size(); t += 3)
    if (n.dot(normal_of(t)) < 0.5f) return std::nullopt;
  for (const Index i : scene.indices)
    if (n.dot(scene.vertices[i].position) < height - tolerance) return std::nullopt;
  return n;
}

}  // namespace

Sphere bounding_sphere(std::span<const Vec3f> points) {
  if (points.empty()) return {};
  // The centre walks toward the farthest point by 1/(i+1): after 1/ε² steps the radius is within 1 + ε.
  constexpr int kSteps = 200;
  Vec3f centre = points[0];
  const auto farthest = [&] {
    std::size_t best = 0;
    float best_squared = -1;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const float squared = (points[i] - centre).squaredNorm();
      if (squared > best_squared) best_squared = squared, best = i;
    }
    return best;
  };
  for (int i = 1; i <= kSteps; ++i) centre += (points[farthest()] - centre) / static_cast<float>(i + 1);
  // A single point still needs a frustum of some size.
  return {centre, std::max((points[farthest()] - centre).norm() * (1 + 1e-5f), 1e-6f)};
}

bool Casters::needs_supports(const Vec3f& to_light) const {
  for (const Vec3f& n : support_normals)
    if (n.dot(to_light) <= 0) return true;
  return false;
}

Casters find_casters(const Scene& scene, int map_size) {
  Casters casters;
  casters.is_support.assign(scene.primitives.size(), false);
  Vec3f low = Vec3f::Constant(std::numeric_limits<float>::max());
  Vec3f high = -low;
  for (const Index i : scene.indices) {
    low = low.cwiseMin(scene.vertices[i].position);
    high = high.cwiseMax(scene.vertices[i].position);
  }
  // Single precision leaves this much of the scene's size in a transformed plane.
  const float tolerance = 1e-5f * (high - low).norm();

  Welder weld;
  enum Run { closed, open, support };
  std::vector<std::pair<Run, std::vector<Index>>> meshes;
  std::vector<Vec3f> object_points;
  std::vector<bool> in_objects;
  for (std::size_t p = 0; p < scene.primitives.size(); ++p) {
    const Primitive& primitive = scene.primitives[p];
    if (!primitive.casts_shadow) continue;
    std::vector<Index> triangles;
    for (Index i = 0; i < primitive.index_count; ++i)
      triangles.push_back(weld(scene.vertices[scene.indices[primitive.first_index + i]].position));
    const auto normal = support_normal(triangles, weld.positions, tolerance, scene);
    casters.is_support[p] = normal.has_value();
    if (normal) {
      casters.support_normals.push_back(*normal);
    } else {
      in_objects.resize(weld.positions.size(), false);
      for (const Index i : triangles) {
        if (in_objects[i]) continue;
        in_objects[i] = true;
        object_points.push_back(weld.positions[i]);
      }
    }
    meshes.emplace_back(normal ? support : is_closed(triangles) ? closed : open, std::move(triangles));
  }
  casters.objects = bounding_sphere(object_points);
  if (map_size > 0) {
    const float texel_m = 2 * casters.objects.radius / static_cast<float>(map_size);
    for (auto& [run, triangles] : meshes)
      if (run != support) triangles = simplify(triangles, weld.positions, kSimplifiedTexels * texel_m);
  }
  std::stable_sort(meshes.begin(), meshes.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  // Corners that are left stand together in the order of their use.
  Welder used;
  Index* const counts[] = {&casters.closed_count, &casters.open_count, &casters.support_count};
  for (const auto& [run, triangles] : meshes) {
    *counts[run] += static_cast<Index>(triangles.size());
    for (const Index i : triangles) casters.indices.push_back(used(weld.positions[i]));
  }
  casters.positions = std::move(used.positions);

  for (std::size_t p = 0; p < scene.primitives.size(); ++p) {
    const Primitive& primitive = scene.primitives[p];
    if (primitive.casts_shadow) continue;
    for (Index i = 0; i < primitive.index_count; ++i)
      object_points.push_back(scene.vertices[scene.indices[primitive.first_index + i]].position);
  }
  casters.scene = bounding_sphere(object_points);
  return casters;
}

}  // namespace lightwell::render
