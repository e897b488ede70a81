// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/light_rows.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "lighting/second_moment.h"

namespace lightwell::render {
namespace {

void set_row(float (&row)[4], const Vec3f& axis, float scale, float middle, const Vec3f& centre) {
  for (int i = 0; i < 3; ++i) row[i] = axis[i] * scale;
  row[3] = middle - scale * axis.dot(centre);
}

}  // namespace

double luminance_of(const LightRow& light) {
  return luminance(Rgbd(Eigen::Map<const Rgb>(light.illuminance).cast<double>()));
}

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
    row.spread = std::tan(std::clamp(light.angular_radius_rad, 0.0f, kLargestAngularRadius));
    rows.push_back(row);
  }
  return rows;
}

namespace {

// Those that shade_fragment.glsl derives.
struct Axes {
  Vec3f u, v;
};
Axes axes_of(const Vec3f& to_light) {
  const Vec3f u =
      (std::abs(to_light.y()) < 0.9f ? Vec3f::UnitY() : Vec3f::UnitX()).cross(to_light).normalized();
  return {u, to_light.cross(u)};
}

Vec3f direction_of(const LightRow& light) {
  return {light.to_light[0], light.to_light[1], light.to_light[2]};
}

struct Range {
  float least = std::numeric_limits<float>::infinity();
  float most = -std::numeric_limits<float>::infinity();
  void add(float x, float around) {
    least = std::min(least, x - around);
    most = std::max(most, x + around);
  }
};

// A rectangle thinner than this would be a map of stretched texels for little.
constexpr float kThinnest = 1.0f / 8;

}  // namespace

void fit_map(LightRow& light, const Casters& drawn, int side) {
  const Axes axes = axes_of(direction_of(light));
  const float radius = std::abs(light.extent_m) / (2 * kDepthPadding);
  Range u, v;
  if (light.extent_m < 0) {
    const Vec3f& centre = drawn.objects.centre;
    for (const Casters::Part& part : drawn.parts) {
      if (drawn.is_support[part.primitive]) continue;
      for (std::uint32_t i = 0; i < part.position_count; ++i) {
        const Vec3f p = drawn.positions[part.first_position + i] - centre;
        u.add(axes.u.dot(p), 0);
        v.add(axes.v.dot(p), 0);
      }
      if (part.position_count > 0) continue;  // with holes: only its bounds are known
      u.add(axes.u.dot(part.bounds.centre - centre), part.bounds.radius);
      v.add(axes.v.dot(part.bounds.centre - centre), part.bounds.radius);
    }
  }
  if (!(u.least <= u.most)) u = v = {-radius, radius};
  float half_u = (u.most - u.least) / 2, half_v = (v.most - v.least) / 2;
  const float thinnest = std::max({kThinnest * half_u, kThinnest * half_v, 1e-3f * radius});
  half_u = std::max(half_u, thinnest);
  half_v = std::max(half_v, thinnest);
  const float inner = 1 - 4 / static_cast<float>(side);
  light.fit[0] = inner / (2 * half_u);
  light.fit[1] = inner / (2 * half_v);
  light.fit[2] = 0.5f - light.fit[0] * (u.least + u.most) / 2;
  light.fit[3] = 0.5f - light.fit[1] * (v.least + v.most) / 2;
  light.texel = 1 / static_cast<float>(side);
}

MapRows map_rows(const LightRow& light, const Casters& casters) {
  const Vec3f d = direction_of(light);
  const Axes axes = axes_of(d);
  const Vec3f& centre = (light.extent_m > 0 ? casters.scene : casters.objects).centre;
  MapRows rows;
  set_row(rows.u, axes.u, light.fit[0], light.fit[2], centre);
  set_row(rows.v, axes.v, light.fit[1], light.fit[3], centre);
  set_row(rows.w, d, -1 / std::abs(light.extent_m), 0.5f, centre);
  return rows;
}

}  // namespace lightwell::render
