// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/caster_outlines.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>

namespace lightwell::render {
namespace {

// Of a triangle's side as the triangle has it: by its corners in rising order, and the corner across.
struct Side {
  std::uint32_t low, high, opposite;
};

// Of a flat primitive.
bool in_front(const Casters& casters, const Casters::Part& part, const Vec3d& eye) {
  const auto corner = [&](std::uint32_t k) -> Vec3d {
    return casters.positions[casters.indices[part.first_index + k]].cast<double>();
  };
  return (corner(1) - corner(0)).cross(corner(2) - corner(0)).dot(eye - corner(0)) > 0;
}

}  // namespace

CasterOutlines::CasterOutlines(const Casters& casters) {
  std::vector<Side> sides;
  for (const Casters::Part& part : casters.parts) {
    std::vector<Edge>& edges = edges_.emplace_back();
    sides.clear();
    for (std::uint32_t i = part.first_index; i + 2 < part.first_index + part.index_count; i += 3)
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t a = casters.indices[i + k], b = casters.indices[i + (k + 1) % 3];
        sides.push_back({std::min(a, b), std::max(a, b), casters.indices[i + (k + 2) % 3]});
      }
    std::sort(sides.begin(), sides.end(), [](const Side& x, const Side& y) {
      return std::tie(x.low, x.high, x.opposite) < std::tie(y.low, y.high, y.opposite);
    });
    // Where more than two triangles meet they are taken two by two.
    for (std::size_t i = 0; i < sides.size();) {
      const Side& side = sides[i];
      const bool two = i + 1 < sides.size() && sides[i + 1].low == side.low && sides[i + 1].high == side.high;
      edges.push_back({side.low, side.high, {side.opposite, two ? sides[i + 1].opposite : side.high}});
      i += two ? 2 : 1;
    }
  }
}

std::vector<CasterOutline> CasterOutlines::seen_from(const Vec3d& eye, const Casters& casters) const {
  std::vector<CasterOutline> outlines;
  for (std::size_t p = 0; p < casters.parts.size(); ++p) {
    const Casters::Part& part = casters.parts[p];
    if (casters.is_support[part.primitive] && in_front(casters, part, eye)) continue;
    CasterOutline outline;
    outline.primitive = part.primitive;
    // Casters do not bound supports.
    const Sphere bounds =
        part.bounds.radius > 0
            ? part.bounds
            : bounding_sphere(std::span(casters.positions).subspan(part.first_position, part.position_count));
    const Vec3d way = bounds.centre.cast<double>() - eye;
    const auto radius = static_cast<double>(bounds.radius);
    outline.distance_m = way.norm();
    if (!(outline.distance_m > 0)) continue;
    outline.direction = way / outline.distance_m;
    outline.half_angle_rad = std::asin(std::min(1.0, radius / outline.distance_m));
    const auto at = [&](std::uint32_t i) -> Vec3d { return casters.positions[i].cast<double>() - eye; };
    for (const Edge& edge : edges_[p]) {
      const Vec3d a = at(edge.a), b = at(edge.b);
      const Vec3d plane = a.cross(b);  // through the eye and the edge
      // Both triangles on one side of that plane: beside the edge the eye looks past the caster.
      if (edge.opposite[1] != edge.b &&
          plane.dot(at(edge.opposite[0])) * plane.dot(at(edge.opposite[1])) <= 0)
        continue;
      const double angle = std::atan2(plane.norm(), a.dot(b)), distance = (a + b).norm() / 2;
      if (!(distance > 0)) continue;
      outline.length_rad += angle;
      outline.rad_per_m += angle / distance;
    }
    if (edges_[p].empty()) {  // one with holes: at least the outline of its bounds
      outline.length_rad = 2 * kPi * std::sin(outline.half_angle_rad);
      outline.rad_per_m = outline.length_rad / outline.distance_m;
    }
    outlines.push_back(outline);
  }
  return outlines;
}

}  // namespace lightwell::render
