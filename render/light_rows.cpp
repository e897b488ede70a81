// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/light_rows.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace lightwell::render {
namespace {

void set_row(float (&row)[4], const Vec3f& axis, float scale, const Vec3f& centre) {
  for (int i = 0; i < 3; ++i) row[i] = axis[i] * scale;
  row[3] = 0.5f - scale * axis.dot(centre);
}

}  // namespace

std::vector<LightRow> make_light_rows(std::span<const DirectionalLight> lights, const Casters& casters) {
  std::vector<LightRow> rows;
  rows.reserve(lights.size());
  for (const DirectionalLight& light : lights) {
    if (!(light.illuminance.maxCoeff() > 0)) continue;
    const Vec3f d = light.direction.normalized();
    const bool with_supports = casters.needs_supports(d);
    float radius = (with_supports ? casters.scene : casters.objects).radius;
    if (!(radius > 0)) radius = 1;  // nothing casts: any map does
    LightRow row{};
    std::copy_n(d.data(), 3, row.to_light);
    row.extent_m = (with_supports ? 2 : -2) * radius * kDepthPadding;
    std::copy_n(light.illuminance.data(), 3, row.illuminance);
    rows.push_back(row);
  }
  return rows;
}

// The axes are those that shade_fragment.glsl derives.
MapRows map_rows(const LightRow& light, const Casters& casters, int side) {
  const Vec3f d(light.to_light[0], light.to_light[1], light.to_light[2]);
  const Vec3f u = (std::abs(d.y()) < 0.9f ? Vec3f::UnitY() : Vec3f::UnitX()).cross(d).normalized();
  const Vec3f v = d.cross(u);
  const float extent = std::abs(light.extent_m);
  const Vec3f& centre = (light.extent_m > 0 ? casters.scene : casters.objects).centre;
  const float across = kDepthPadding / extent * (1 - 4 / static_cast<float>(side));
  MapRows rows;
  set_row(rows.u, u, across, centre);
  set_row(rows.v, v, across, centre);
  set_row(rows.w, d, -1 / extent, centre);
  return rows;
}

}  // namespace lightwell::render
