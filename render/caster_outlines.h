// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "render/casters.h"

namespace lightwell::render {

// The outline of what casts, as a point sees it: where the shadow of a light at that point has its edges.
struct CasterOutline {
  std::size_t primitive = 0;         // of the scene
  Vec3d direction = Vec3d::UnitY();  // unit, world, from the point to the middle of the caster's bounds
  double distance_m = 0;             // to there
  double half_angle_rad = 0;         // of the bounds; π/2 from inside them
  // Over all edges, those behind others among them: an edge's angle, and its angle over its distance.
  double length_rad = 0, rad_per_m = 0;
};

class CasterOutlines {
 public:
  explicit CasterOutlines(const Casters& casters);
  // casters: those that it was made of, as they stand. A support has none from before it.
  [[nodiscard]] std::vector<CasterOutline> seen_from(const Vec3d& eye, const Casters& casters) const;

 private:
  struct Edge {
    std::uint32_t a, b;  // positions
    std::array<std::uint32_t, 2>
        opposite;  // third corners of its triangles, the second b where there is one only
  };
  std::vector<std::vector<Edge>> edges_;  // of each part
};

}  // namespace lightwell::render
