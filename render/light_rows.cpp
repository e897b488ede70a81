// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/light_rows.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace lightwell::render {
namespace {

void set_row(float (&row)[4], const Vec3f& axis, float scale, float middle, const Vec3f& centre) {
  for (int i = 0; i < 3; ++i) row[i] = axis[i] * scale;
  row[3] = middle - scale * axis.dot(centre);
}

}  // namespace

std::vector<LightRow> make_light_rows(std::span<const DirectionalLight> lights, const Casters& casters,
                                      int map_size) {
  std::vector<LightRow> rows;
  rows.reserve(lights.size());
  for (const DirectionalLight& light : lights) {
    if (!(light.illuminance.maxCoeff() > 0)) continue;
    const Vec3f d = light.direction.normalized();
    const bool with_supports = casters.needs_supports(d);
    Sphere sphere = with_supports ? casters.scene : casters.objects;
    if (!(sphere.radius > 0)) sphere.radius = 1;  // nothing casts: any map does
    LightRow row{};
    const float extent = 2 * sphere.radius * kDepthPadding;
    set_row(row.w, d, -1 / extent, 0.5f, sphere.centre);
    // The direction as shaders read it from w, to the last bit: they choose the same axes.
    const Vec3f read(row.w[0] * -extent, row.w[1] * -extent, row.w[2] * -extent);
    const Vec3f u = (std::abs(read.y()) < 0.9f ? Vec3f::UnitY() : Vec3f::UnitX()).cross(read).normalized();
    const Vec3f v = read.cross(u);
    const float across = 0.5f / sphere.radius * (1 - 4 / static_cast<float>(map_size));
    set_row(row.u, u, across, 0.5f, sphere.centre);
    set_row(row.v, v, across, 0.5f, sphere.centre);
    std::copy_n(light.illuminance.data(), 3, row.illuminance);
    row.extent_m = with_supports ? extent : -extent;
    rows.push_back(row);
  }
  std::stable_partition(rows.begin(), rows.end(), [](const LightRow& row) { return row.extent_m < 0; });
  return rows;
}

}  // namespace lightwell::render
