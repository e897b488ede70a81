// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/fit/shadow_ground.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lightwell {
namespace {

constexpr int kSide = 16;
static_assert(kSide * kSide == kGroundPoints);
constexpr double kSpacing = 6.0 / kSide;
constexpr double kHalfEdge = 4 * kPi / 180;

// Part of a light that is seen, by how far it is outside the outline in units of half the edge: 0 at −1, 1 at 1, both
// with slope 0.
double seen(double outside) {
  if (outside <= -1) return 0;
  if (outside >= 1) return 1;
  return 0.5 + outside * (0.75 - 0.25 * outside * outside);
}
double seen_slope(double outside) {
  return std::abs(outside) < 1 ? 0.75 * (1 - outside * outside) : 0;
}

}  // namespace

ShadowGround::ShadowGround() {
  for (int row = 0; row < kSide; ++row)
    for (int column = 0; column < kSide; ++column) {
      const Vec3d point((column + 0.5 - kSide / 2.0) * kSpacing, 0, (row + 0.5 - kSide / 2.0) * kSpacing);
      const Vec3d to_centre = Vec3d::UnitY() - point;
      const double distance = to_centre.norm();
      points_.push_back({to_centre / distance, point.norm() / distance, 1 / distance, distance});
    }
}

// Outside the outline by (cos outline − cos light) / sin outline: the angle between, to first order.
void ShadowGround::light_column(const Vec3d& direction, double* values) const noexcept {
  const double cosine = std::max(0.0, direction.y());
  for (const Point& p : points_)
    *values++ = cosine * seen((p.cosine - direction.dot(p.to_centre)) / (p.sine * kHalfEdge));
}

void ShadowGround::slope_columns(const Vec3d& direction, const Vec3d& t, const Vec3d& u, double* along_t,
                                 double* along_u) const noexcept {
  const bool above = direction.y() > 0;
  for (const Point& p : points_) {
    const double outside = (p.cosine - direction.dot(p.to_centre)) / (p.sine * kHalfEdge);
    const double part = above ? seen(outside) : 0;
    const double slope = above ? -direction.y() * seen_slope(outside) / (p.sine * kHalfEdge) : 0;
    *along_t++ = t.y() * part + slope * t.dot(p.to_centre);
    *along_u++ = u.y() * part + slope * u.dot(p.to_centre);
  }
}

// A soft edge hides as much of an even sky as the sharp one to second order of its width; the sum over the sphere's own
// form factor (1/D)² · (1/D) is kept, which the ambient term of evaluate.h has.
void ShadowGround::ambient_column(double* values) const noexcept {
  for (const Point& p : points_) *values++ = kPi * (1 - 1 / (p.distance * p.distance * p.distance));
}

GroundIrradiance ShadowGround::irradiance(const PolarMap& map) const {
  GroundIrradiance sum = GroundIrradiance::Zero();
  std::vector<double> column(kGroundPoints);
  const Eigen::Map<const Eigen::Array<double, kGroundPoints, 1>> values(column.data());
  for (int ring = 0; ring < map.grid.rings; ++ring)
    for (int sector = 0; sector < map.grid.sectors; ++sector) {
      const Vec3d direction = map.grid.bin_direction(ring, sector);
      if (direction.y() <= 0) break;
      const std::size_t bin = static_cast<std::size_t>(ring) * static_cast<std::size_t>(map.grid.sectors) +
                              static_cast<std::size_t>(sector);
      light_column(direction, column.data());
      const Rgb radiance = map.rgb(bin);
      for (int c = 0; c < 3; ++c) {
        const bool is_light = radiance[c] > 0 && radiance[c] <= std::numeric_limits<float>::max();
        if (!is_light) continue;
        const double light = static_cast<double>(radiance[c]) * static_cast<double>(map.solid_angle_sr[bin]);
        sum.col(c) += values * light;
      }
    }
  return sum;
}

}  // namespace lightwell
