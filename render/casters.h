// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/scene.h"

namespace lightwell::render {

struct Sphere {
  Vec3f centre = Vec3f::Zero();
  float radius = 0;  // 0: empty
};

// What casts shadows, prepared for shadow maps. Vertices of equal position are welded.
//
// A flat primitive with the whole scene on its front side (a floor, a wall of a room) supports the scene. It
// cannot block a light in front of it, and blocks everything else from a light behind it. So maps never have
// to reach over it: they fit the objects, and supports are drawn into the maps of lights behind them, nearer
// than everything.
struct Casters {
  std::vector<Vec3f> positions;
  // Three runs: closed meshes (every edge is shared by two triangles that run along it in opposite
  // directions), open ones, supports.
  std::vector<std::uint32_t> indices;
  std::uint32_t closed_count = 0;
  std::uint32_t open_count = 0;
  std::uint32_t support_count = 0;
  std::vector<Vec3f> support_normals;
  std::vector<bool> is_support;  // a primitive of the scene
  Sphere objects;                // bounds closed and open
  Sphere scene;                  // bounds all but the supports, casting or not

  // True where the light is behind a support.
  [[nodiscard]] bool needs_supports(const Vec3f& to_light) const;
};

// Of a texel: how far simplified casters may be from those of the scene. A quarter is not seen among the 2×2
// texels that a look-up takes part of.
inline constexpr float kSimplifiedTexels = 0.25f;

// map_size: texels a side of the shadow maps they are drawn into; the objects are simplified by at most
// kSimplifiedTexels of them. 0: every triangle of the scene. Bounds and supports are the scene's either way.
Casters find_casters(const Scene& scene, int map_size = 0);

// Within 1 % of the smallest (Bădoiu and Clarkson 2003); contains every point.
Sphere bounding_sphere(std::span<const Vec3f> points);

}  // namespace lightwell::render
