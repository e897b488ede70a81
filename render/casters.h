// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/bounding_sphere.h"
#include "render/scene.h"

namespace lightwell::render {

// What casts shadows, prepared for shadow maps. Vertices of equal position are welded, primitive by primitive.
//
// A flat primitive with the whole scene on its front side (a floor, a wall of a room) supports the scene. It
// cannot block a light in front of it, and blocks everything else from a light behind it. So maps never have
// to reach over it: they fit the objects, and supports are drawn into the maps of lights behind them, nearer
// than everything. What moves is no support, and may sink into one to its middle.
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

  // A primitive that casts, in the order of the runs.
  struct Part {
    std::size_t primitive = 0;  // of the scene
    std::uint32_t first_index = 0;
    std::uint32_t index_count = 0;
    std::uint32_t first_position = 0;
    std::uint32_t position_count = 0;
    Sphere bounds;       // of the primitive as it is seen
    bool moved = false;  // by the last move()
  };
  std::vector<Part> parts;
  // Primitives with holes, which stand in no run: they are drawn as they are seen. Their parts have no triangles.
  std::vector<std::size_t> cutouts;

  // Of a scene that moves: the vertex that each position is, and what the spheres bound: a primitive each, first those
  // that cast.
  std::vector<std::uint32_t> vertices;
  struct Body {
    std::size_t primitive = 0;
    bool casts = true;
    std::vector<Vec3f> positions;
    std::vector<std::uint32_t> vertices;
  };
  std::vector<Body> bodies;

  // True where the light is behind a support.
  [[nodiscard]] bool needs_supports(const Vec3f& to_light) const;
  // Follows these primitives of the scene that this was made of; the spheres become what they would be of the scene as
  // it now stands. Triangles stay those found at time 0.
  void move(const Scene& scene, std::span<const std::size_t> moved);
  // How far a vertex of those of these primitives that cast is at most, in the scene as it now stands, from where it is
  // here. Metres.
  [[nodiscard]] float farthest_move(const Scene& scene, std::span<const std::size_t> moved) const;
};

// Of a texel: how far simplified casters may be from those of the scene. A quarter is not seen among the 2×2
// texels that a look-up takes part of.
inline constexpr float kSimplifiedTexels = 0.25f;

// map_size: texels a side of the shadow maps they are drawn into; the objects are simplified by at most
// kSimplifiedTexels of them, what bends or grows in nine poses of its animation. 0: every triangle of the scene.
// Bounds and supports are the scene's either way.
Casters find_casters(const Scene& scene, int map_size = 0);
// The same for maps of several sizes, from the largest to the smallest; large meshes are simplified from level to level.
std::vector<Casters> find_casters(const Scene& scene, std::span<const int> map_sizes);

}  // namespace lightwell::render
