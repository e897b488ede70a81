// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/luminaire/far_field.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace lightwell {
namespace {

constexpr double kRad = kPi / 180;

// Where an angle lies between those of a table: angles[low] + part · step.
struct Between {
  std::size_t low = 0, high = 0;
  double part = 0;
};

std::optional<Between> find(const std::vector<double>& angles, double angle) {
  if (!(angle >= angles.front()) || !(angle <= angles.back())) return std::nullopt;
  const auto above =
      static_cast<std::size_t>(std::upper_bound(angles.begin(), angles.end(), angle) - angles.begin());
  if (above == angles.size()) return Between{above - 1, above - 1, 0};
  return Between{above - 1, above, (angle - angles[above - 1]) / (angles[above] - angles[above - 1])};
}

// On a circle of 360°.
Between find_around(const std::vector<double>& angles, double angle) {
  if (angles.size() == 1) return {};
  double turned = std::fmod(angle - angles.front(), 360.0);
  if (turned < 0) turned += 360;
  const double absolute = angles.front() + turned;
  if (const auto found = find(angles, absolute)) return *found;
  const double gap = angles.front() + 360 - angles.back();
  return {angles.size() - 1, 0, (absolute - angles.back()) / gap};
}

// ∫ w dx and ∫ (x − a) w dx from a to b for w = sin x; radians.
std::array<double, 2> sine_moments(double a, double b) {
  return {std::cos(a) - std::cos(b), std::sin(b) - std::sin(a) - (b - a) * std::cos(b)};
}
// The same for w = cos x.
std::array<double, 2> cosine_moments(double a, double b) {
  return {std::sin(b) - std::sin(a), (b - a) * std::sin(b) + std::cos(b) - std::cos(a)};
}
std::array<double, 2> plain_moments(double a, double b) {
  return {b - a, (b - a) * (b - a) / 2};
}

// Weights of a table's angles in ∫ f w dx, f linear between them.
template <class Moments>
std::vector<double> quadrature(const std::vector<double>& deg, const Moments& moments) {
  std::vector<double> weights(deg.size(), 0.0);
  for (std::size_t i = 0; i + 1 < deg.size(); ++i) {
    const double a = deg[i] * kRad, b = deg[i + 1] * kRad;
    const auto [zeroth, first] = moments(a, b);
    weights[i + 1] += first / (b - a);
    weights[i] += zeroth - first / (b - a);
  }
  return weights;
}

std::vector<double> quadrature_around(const std::vector<double>& deg) {
  if (deg.size() == 1) return {2 * kPi};
  std::vector<double> weights = quadrature(deg, plain_moments);
  const double gap = (deg.front() + 360 - deg.back()) * kRad;
  weights.front() += gap / 2;
  weights.back() += gap / 2;
  return weights;
}

}  // namespace

PhotometricAngles photometric_angles(PhotometricSystem system, const Vec3d& d) {
  const auto arc = [](double x) { return std::asin(std::clamp(x, -1.0, 1.0)) / kRad; };
  switch (system) {
    case PhotometricSystem::b:
      return {arc(d.x()), std::atan2(d.y(), -d.z()) / kRad};
    case PhotometricSystem::a:
      return {std::atan2(d.x(), -d.z()) / kRad, arc(d.y())};
    case PhotometricSystem::c:
      break;
  }
  double c = std::atan2(d.y(), d.x()) / kRad;
  if (c < 0) c += 360;
  // As exact near the aim as beside it.
  return {c, std::atan2(std::hypot(d.x(), d.y()), -d.z()) / kRad};
}

Vec3d photometric_direction(PhotometricSystem system, const PhotometricAngles& angles) {
  const double h = angles.horizontal_deg * kRad, v = angles.vertical_deg * kRad;
  switch (system) {
    case PhotometricSystem::b:
      return {std::sin(h), std::cos(h) * std::sin(v), -std::cos(h) * std::cos(v)};
    case PhotometricSystem::a:
      return {std::cos(v) * std::sin(h), std::sin(v), -std::cos(v) * std::cos(h)};
    case PhotometricSystem::c:
      break;
  }
  return {std::sin(v) * std::cos(h), std::sin(v) * std::sin(h), -std::cos(v)};
}

double intensity(const FarField& lamp, const PhotometricAngles& angles) {
  std::optional<Between> h;
  if (lamp.system == PhotometricSystem::c)
    h = find_around(lamp.horizontal_deg, angles.horizontal_deg);
  else
    h = find(lamp.horizontal_deg, angles.horizontal_deg);
  const auto v = find(lamp.vertical_deg, angles.vertical_deg);
  if (!h || !v) return 0;
  const auto along = [&](std::size_t i) {
    return (1 - v->part) * lamp.at(i, v->low) + v->part * lamp.at(i, v->high);
  };
  return (1 - h->part) * along(h->low) + h->part * along(h->high);
}

double intensity(const FarField& lamp, const Vec3d& direction) {
  PhotometricAngles angles = photometric_angles(lamp.system, direction);
  // Rounding must not darken the table's last angles.
  constexpr double kRounding_deg = 1e-9;
  const auto settle = [](double& angle, const std::vector<double>& table) {
    if (angle < table.front() && angle > table.front() - kRounding_deg) angle = table.front();
    if (angle > table.back() && angle < table.back() + kRounding_deg) angle = table.back();
  };
  settle(angles.vertical_deg, lamp.vertical_deg);
  if (lamp.system != PhotometricSystem::c) settle(angles.horizontal_deg, lamp.horizontal_deg);
  return intensity(lamp, angles);
}

double luminous_flux(const FarField& lamp) {
  std::vector<double> across, along;
  switch (lamp.system) {
    case PhotometricSystem::c:
      across = quadrature_around(lamp.horizontal_deg);
      along = quadrature(lamp.vertical_deg, sine_moments);
      break;
    case PhotometricSystem::b:
      across = quadrature(lamp.horizontal_deg, cosine_moments);
      along = quadrature(lamp.vertical_deg, plain_moments);
      break;
    case PhotometricSystem::a:
      across = quadrature(lamp.horizontal_deg, plain_moments);
      along = quadrature(lamp.vertical_deg, cosine_moments);
      break;
  }
  double flux = 0;
  for (std::size_t h = 0; h < across.size(); ++h)
    for (std::size_t v = 0; v < along.size(); ++v) flux += across[h] * along[v] * lamp.at(h, v);
  return flux;
}

double illuminance(const FarField& lamp, const Vec3d& point, const Vec3d& normal) {
  const double square = point.squaredNorm();
  const double facing = -point.dot(normal);
  if (!(square > 0) || !(facing > 0)) return 0;
  const double distance = std::sqrt(square);
  return intensity(lamp, Vec3d(point / distance)) * facing / (square * distance);
}

}  // namespace lightwell
