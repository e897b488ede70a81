// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/enclosing_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>

namespace lightwell::render {
namespace {

// To the corners of a tetrahedron, askew, so that no edge of a box lies on them.
const std::array<Vec3d, 4> kRays = {Vec3d(0.93, 1.11, 1.04), Vec3d(-1.07, -0.96, 1.02),
                                    Vec3d(-0.98, 1.05, -0.91), Vec3d(1.03, -0.94, -1.09)};

// True where the nearest of a primitive's triangles along a ray is met from behind.    source: Möller and Trumbore 1997
bool leaves(const Scene& scene, const Primitive& primitive, const Vec3d& from, const Vec3d& ray) {
  double nearest = std::numeric_limits<double>::infinity();
  bool from_behind = false;
  for (std::uint32_t i = primitive.first_index; i + 2 < primitive.first_index + primitive.index_count;
       i += 3) {
    const auto corner = [&](std::uint32_t c) -> Vec3d {
      return scene.vertices[scene.indices[i + c]].position.cast<double>();
    };
    const Vec3d a = corner(0), ab = corner(1) - a, ac = corner(2) - a, to = from - a;
    const Vec3d p = ray.cross(ac), q = to.cross(ab);
    const double det = ab.dot(p);  // below 0: along the normal
    if (det == 0) continue;
    const double u = to.dot(p) / det, v = ray.dot(q) / det, at = ac.dot(q) / det;
    if (u < 0 || v < 0 || u + v > 1 || at <= 0 || at >= nearest) continue;
    nearest = at;
    from_behind = det < 0;
  }
  return from_behind;
}

}  // namespace

std::optional<std::size_t> enclosing_mesh(const Scene& scene, const Vec3d& point) {
  for (std::size_t p = 0; p < scene.primitives.size(); ++p) {
    const Primitive& primitive = scene.primitives[p];
    if (!primitive.casts_shadow ||
        scene.materials[static_cast<std::size_t>(primitive.material)].alpha_cutoff > 0)
      continue;
    if (std::all_of(kRays.begin(), kRays.end(),
                    [&](const Vec3d& ray) { return leaves(scene, primitive, point, ray); }))
      return p;
  }
  return std::nullopt;
}

}  // namespace lightwell::render
