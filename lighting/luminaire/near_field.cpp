// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/luminaire/near_field.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lighting/result.h"

namespace lightwell {
namespace {

// From three spacings on the sum over the positions themselves errs by less than what interpolation between them does.
constexpr double kSpacingsADistance = 3;
constexpr int kMostSubdivision = 16;

// ∫ x^p Φ'(x) dx, p up to 4: three Gauss–Legendre points a quarter of the pieces, which are quadratic, are exact to p = 3
// and to 1e-8 for 4.
double dual_moment(BellDual filter, int power) {
  const double reach = bell_dual_reach(filter);
  constexpr double kWidth = 0.125;
  const double offset = std::sqrt(0.6) / 2 * kWidth;
  double sum = 0;
  for (double middle = -reach + kWidth / 2; middle < reach; middle += kWidth)
    for (const auto& [x, w] : {std::pair(middle - offset, 5.0 / 18), std::pair(middle, 8.0 / 18),
                               std::pair(middle + offset, 5.0 / 18)})
      sum += kWidth * w * std::pow(x, power) * bell_dual(filter, x);
  return sum;
}

// E = F + m₂/2 F″ + m₄/24 F⁗ solved for F, with differences for derivatives, F″ = δ² − δ⁴/12 and F⁗ = δ⁴: the weights of
// E at a position, its neighbours and the next.
std::array<double, 3> deconvolution(BellDual filter) {
  const double m2 = dual_moment(filter, 2), m4 = dual_moment(filter, 4);
  const double second = -m2 / 2, fourth = m2 * m2 / 4 - m4 / 24 + m2 / 24;
  return {1 - 2 * second + 6 * fourth, second - 4 * fourth, fourth};
}

// Along one axis; beyond the positions there is no light.
LampImages deconvolve(const LampImages& in, int axis, const std::array<double, 3>& taps) {
  LampImages out{in.planes, std::vector<Rgb>(in.values.size(), Rgb::Zero())};
  for (int v = 0; v < in.planes.positions[1]; ++v)
    for (int u = 0; u < in.planes.positions[0]; ++u)
      for (int k = -2; k <= 2; ++k) {
        const int from = (axis == 0 ? u : v) + k;
        if (from < 0 || from >= in.planes.positions[static_cast<std::size_t>(axis)]) continue;
        const Rgb* source = axis == 0 ? in.image(from, v) : in.image(u, from);
        Rgb* target = out.image(u, v);
        const auto weight = static_cast<float>(taps[static_cast<std::size_t>(std::abs(k))]);
        for (std::size_t i = 0; i < in.planes.image_size(); ++i) target[i] += weight * source[i];
      }
  return out;
}

// What makes the intensity of a square of sampling plane from what is alike at neighbours: of planes L cos² / R², so that
// I = L cos · square = (L cos² / R²) R³ / d · square; of hemispheres L cos itself.
double intensity_factor(const LampPlanes& planes, const Vec2d& sampling, const Vec2d& measurement) {
  if (planes.map == LampMap::hemisphere) return planes.spacing_m * planes.spacing_m;
  const double d = planes.distance_m;
  const double square = d * d + (measurement - sampling).squaredNorm();
  return planes.spacing_m * planes.spacing_m * square * std::sqrt(square) / d;
}

// Of a source between positions, as if it had a square of the grid to itself; place: in spacings from the first.
Rgbd intensity_between(const NearField& lamp, const Vec2d& place, const Vec2d& measurement) {
  const LampPlanes& planes = lamp.intensity.planes;
  const Vec2d corner = place.array().floor();
  const auto across = cubic_weights(place.x() - corner.x()), along = cubic_weights(place.y() - corner.y());
  Rgbd sum = Rgbd::Zero();
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) {
      const double weight = across[static_cast<std::size_t>(i)] * along[static_cast<std::size_t>(j)];
      const int u = static_cast<int>(corner.x()) + i - 1, v = static_cast<int>(corner.y()) + j - 1;
      if (weight == 0 || u < 0 || v < 0 || u >= planes.positions[0] || v >= planes.positions[1]) continue;
      sum += weight / intensity_factor(planes, planes.position(u, v), measurement) *
             lamp.intensity.at(u, v, measurement);
    }
  return sum * intensity_factor(planes, planes.first_m + planes.spacing_m * place, measurement);
}

// Sources along one axis of the grid, counted in parts of a spacing.
struct Sites {
  int first, last, a_spacing;
};
// All of cubic convolution's support, negative lobes and two spacings beyond the outer positions included: each
// position's weights then sum to one and have no first or second moment, so that neither flux nor far light depends on the
// subdivision. One row is a line: nothing tells how wide it is.
Sites sites_along(int positions, int subdivision) {
  if (positions == 1 || subdivision == 1) return {0, positions - 1, 1};
  const int beyond = 2 * subdivision - 1;
  return {-beyond, (positions - 1) * subdivision + beyond, subdivision};
}

}  // namespace

NearField point_sources(const MeasuredLamp& lamp) {
  verify_bug(lamp.irradiance.planes.map == LampMap::plane, "a rig measures on a plane");
  const std::array<double, 3> taps = deconvolution(lamp.filter);
  LampImages images = deconvolve(deconvolve(lamp.irradiance, 0, taps), 1, taps);
  const LampPlanes& planes = images.planes;
  for (int v = 0; v < planes.positions[1]; ++v)
    for (int u = 0; u < planes.positions[0]; ++u) {
      Rgb* pixel = images.image(u, v);
      for (int t = 0; t < planes.pixels[1]; ++t)
        for (int s = 0; s < planes.pixels[0]; ++s)
          *pixel++ *=
              static_cast<float>(intensity_factor(planes, planes.position(u, v), planes.pixel_centre(s, t)));
    }
  return {std::move(images)};
}

int subdivision_at(const NearField& lamp, double distance_m) {
  const double wanted = kSpacingsADistance * lamp.intensity.planes.spacing_m / distance_m;
  return wanted > kMostSubdivision ? kMostSubdivision
                                   : std::max(1, static_cast<int>(std::ceil(wanted - 1e-9)));
}

Rgbd illuminance(const NearField& lamp, const Vec3d& point, const Vec3d& normal, int subdivision) {
  const LampPlanes& planes = lamp.intensity.planes;
  if (!(point.z() < planes.z_m)) return Rgbd::Zero();
  const Sites across = sites_along(planes.positions[0], subdivision);
  const Sites down = sites_along(planes.positions[1], subdivision);
  Rgbd sum = Rgbd::Zero();
  for (int j = down.first; j <= down.last; ++j)
    for (int i = across.first; i <= across.last; ++i) {
      const Vec2d place(static_cast<double>(i) / across.a_spacing, static_cast<double>(j) / down.a_spacing);
      const Vec2d from = planes.first_m + planes.spacing_m * place;
      const Vec3d way = point - planes.place(from);
      const double facing = -way.dot(normal);
      if (!(facing > 0)) continue;
      const double square = way.squaredNorm();
      sum +=
          intensity_between(lamp, place, planes.on_map(from, way)) * (facing / (square * std::sqrt(square)));
    }
  return (sum / (across.a_spacing * down.a_spacing)).max(0.0);
}

Rgbd luminous_flux(const NearField& lamp) {
  const LampPlanes& planes = lamp.intensity.planes;
  Rgbd sum = Rgbd::Zero();
  for (int v = 0; v < planes.positions[1]; ++v)
    for (int u = 0; u < planes.positions[0]; ++u) {
      const Rgb* pixel = lamp.intensity.image(u, v);
      for (int t = 0; t < planes.pixels[1]; ++t)
        for (int s = 0; s < planes.pixels[0]; ++s, ++pixel)
          sum += pixel->cast<double>() * planes.pixel_solid_angle_sr(planes.position(u, v), s, t);
    }
  return sum;
}

}  // namespace lightwell
