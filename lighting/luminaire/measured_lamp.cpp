// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/luminaire/measured_lamp.h"

#include <algorithm>
#include <cmath>

namespace lightwell {
namespace {

// R⁴ / d², the inverse of cos² / R² between the planes.
double inverse_geometry(const LampPlanes& planes, const Vec2d& sampling, const Vec2d& measurement) {
  const double d = planes.distance_m;
  const double square = d * d + (measurement - sampling).squaredNorm();
  return square * square / (d * d);
}

struct Node {
  double x, weight;
};

// Three-point Gauss–Legendre panels of width ½ / steps over ±reach.
std::vector<Node> filter_nodes(BellDual filter, int steps) {
  const double reach = std::min(bell_dual_reach(filter), 6.0);  // α⁶ is 1e-5 of a filter nobody can build
  const double width = 0.5 / steps, offset = std::sqrt(0.6) / 2 * width;
  std::vector<Node> nodes;
  const int panels = static_cast<int>(std::lround(2 * reach / width));
  for (int i = 0; i < panels; ++i) {
    const double middle = -reach + (i + 0.5) * width;
    for (const auto& [x, w] : {std::pair(middle - offset, 5.0 / 18), std::pair(middle, 8.0 / 18),
                               std::pair(middle + offset, 5.0 / 18)})
      if (const double value = bell_dual(filter, x); value != 0) nodes.push_back({x, width * w * value});
  }
  return nodes;
}

}  // namespace

Rgbd radiance(const MeasuredLamp& lamp, LampForm form, const Vec2d& sampling, const Vec2d& measurement) {
  const LampPlanes& planes = lamp.irradiance.planes;
  const Vec2d place = (sampling - planes.first_m) / planes.spacing_m;
  const int u0 = static_cast<int>(std::floor(place.x())), v0 = static_cast<int>(std::floor(place.y()));
  Rgbd sum = Rgbd::Zero();
  for (int v = std::max(v0, 0); v <= std::min(v0 + 1, planes.positions[1] - 1); ++v)
    for (int u = std::max(u0, 0); u <= std::min(u0 + 1, planes.positions[0] - 1); ++u) {
      const double weight = bell(place.x() - u) * bell(place.y() - v);
      if (weight == 0) continue;
      const Vec2d& from = form == LampForm::exact ? sampling : planes.position(u, v);
      sum += weight * inverse_geometry(planes, from, measurement) * lamp.irradiance.at(u, v, measurement);
    }
  return sum;
}

Rgbd illuminance(const MeasuredLamp& lamp, LampForm form, const Vec3d& point, const Vec3d& normal) {
  const LampPlanes& planes = lamp.irradiance.planes;
  if (!(point.z() < planes.z_m)) return Rgbd::Zero();
  // The bells' pieces are half a spacing wide; the span ends one spacing beyond the outer positions.
  const double piece = planes.spacing_m / 2, offset = piece / 2 / std::sqrt(3.0);
  Rgbd sum = Rgbd::Zero();
  const int pieces_u = 2 * (planes.positions[0] + 1), pieces_v = 2 * (planes.positions[1] + 1);
  for (int j = 0; j < 2 * pieces_v; ++j)
    for (int i = 0; i < 2 * pieces_u; ++i) {
      const auto along = [&](int k) {
        return (k / 2 + 0.5) * piece - planes.spacing_m + (k % 2 == 0 ? -offset : offset);
      };
      const Vec2d sampling = planes.first_m + Vec2d(along(i), along(j));
      const Vec3d way = point - planes.place(sampling);
      const double square = way.squaredNorm(), facing = -way.dot(normal);
      if (!(facing > 0)) continue;
      const Vec2d measurement = sampling + way.head<2>() * (planes.distance_m / -way.z());
      sum += radiance(lamp, form, sampling, measurement) * (-way.z() * facing / (square * square));
    }
  return sum * (piece * piece / 4);
}

MeasuredLamp measure(const LampRadiance& lamp, const LampPlanes& planes, BellDual filter, int steps) {
  MeasuredLamp out{{planes, std::vector<Rgb>(planes.images() * planes.image_size())}, filter};
  const std::vector<Node> nodes = filter_nodes(filter, steps);
  for (int v = 0; v < planes.positions[1]; ++v)
    for (int u = 0; u < planes.positions[0]; ++u) {
      Rgb* image = out.irradiance.image(u, v);
      for (int t = 0; t < planes.pixels[1]; ++t)
        for (int s = 0; s < planes.pixels[0]; ++s) {
          const Vec2d measurement = planes.pixel_centre(s, t);
          Rgbd sum = Rgbd::Zero();
          for (const Node& y : nodes)
            for (const Node& x : nodes) {
              const Vec2d sampling = planes.position(u, v) + planes.spacing_m * Vec2d(x.x, y.x);
              sum += x.weight * y.weight / inverse_geometry(planes, sampling, measurement) *
                     lamp(sampling, measurement);
            }
          *image++ = sum.cast<float>();
        }
    }
  return out;
}

}  // namespace lightwell
