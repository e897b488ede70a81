// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "render/casters.h"
#include "render/lamp_sources.h"

namespace lightwell::render {

// How what casts is seen from a lamp's sources: a perspective map each, fitted to what casts in the light; from amid of it
// the faces of a cube.
struct LampViews {
  // From the lamp's frame to the maps': right, up, forward.
  Eigen::Matrix3d map_from_lamp = Eigen::Matrix3d::Identity();
  int faces = 1;  // a source: one forward, 5 without the one backward, or 6
  // From tangents to the map's square [0, 1]²: scales, then offsets; scale 0: nothing casts there. [source][face]
  std::vector<std::array<float, 4>> fits;
  double near_m = 0.1, far_m = 1;  // along a face's axis
  bool with_supports = false;      // a support is between the lamp and the scene
  bool inside = false;             // a closed mesh may have the lamp inside

  // World to clip space of one map.
  [[nodiscard]] Mat4f clip_from_world(const LampSources& lamp, const Eigen::Isometry3d& world_from_lamp,
                                      std::size_t source, int face) const;
  // True where that map shows the scene as in a mirror, so that triangles turn inside out.
  [[nodiscard]] bool mirrors(int face) const { return faces > 1 && (face == 2 || face == 3 || face == 5); }
  // Of depths in a map, 0 to 1: first − second / metres along the face's axis.
  [[nodiscard]] std::array<float, 2> depth_terms() const;
  [[nodiscard]] bool empty() const;  // nothing casts in the light
  // The least width of a texel, metres, where what casts is nearest; side: texels of a map.
  [[nodiscard]] double least_texel_m(int side) const;
};
LampViews find_lamp_views(const LampSources& lamp, const Eigen::Isometry3d& world_from_lamp,
                          const Casters& casters, int side);

}  // namespace lightwell::render
