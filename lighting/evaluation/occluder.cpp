// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/evaluation/occluder.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lightwell {
namespace {

constexpr double kBoxHalf = 0.7;
constexpr double kBoxHeight = 2;
constexpr double kPoleRadius = 0.15;
constexpr double kPoleHeight = 3;
constexpr double kCanopyRadius = 1.5;
constexpr double kCanopyHeight = 2;
constexpr AzimuthArc kNothing{0, 0};
constexpr AzimuthArc kEverything{0, kPi};

double azimuth(double x, double z) {
  return std::atan2(x, z);
}

double acos_within(double cosine) {
  return std::acos(std::clamp(cosine, -1.0, 1.0));
}

// Where along a ring amplitude · cos(λ − middle) > needed.
double half_arc(double amplitude, double needed) {
  const double cosine = amplitude > 0 ? needed / amplitude : (needed < 0 ? -2 : 2);
  return cosine >= 1 ? 0 : cosine < -1 ? kPi : std::acos(cosine);
}

// The sphere hides direction d from ground point p where d · (centre − p) > |p|: the distance to the tangent
// points.
AzimuthArc hidden_by_sphere(const Vec3d& point, double sin_theta, double cos_theta) {
  const double horizontal = std::hypot(point.x(), point.z());
  return {horizontal > 0 ? azimuth(-point.x(), -point.z()) : 0,
          half_arc(sin_theta * horizontal, horizontal - cos_theta)};
}

bool inside_box(double x, double z) {
  return std::abs(x) < kBoxHalf && std::abs(z) < kBoxHalf;
}

// Extreme azimuths, about the middle, of what of the footprint lies within `reach` of the point: corners inside
// the circle and crossings of sides with it.
AzimuthArc hidden_by_box(const Vec3d& point, double sin_theta, double cos_theta) {
  if (inside_box(point.x(), point.z())) return kEverything;
  const double reach = kBoxHeight * sin_theta / cos_theta;
  const double middle =
      azimuth(-point.x(), -point.z());  // seen from outside all of it lies within ±90° of this
  double least = 4;
  double largest = -4;
  const auto take = [&](double dx, double dz) {
    const double turn = std::remainder(azimuth(dx, dz) - middle, 2 * kPi);
    least = std::min(least, turn);
    largest = std::max(largest, turn);
  };
  for (const double x : {-kBoxHalf, kBoxHalf})
    for (const double z : {-kBoxHalf, kBoxHalf})
      if (std::hypot(x - point.x(), z - point.z()) <= reach) take(x - point.x(), z - point.z());
  for (const double side : {-kBoxHalf, kBoxHalf}) {
    for (const bool along_z : {false, true}) {
      const double across = side - (along_z ? point.x() : point.z());
      const double offset = along_z ? point.z() : point.x();
      const double squared = reach * reach - across * across;
      if (squared < 0) continue;
      for (const double along : {-std::sqrt(squared), std::sqrt(squared)}) {
        if (std::abs(along + offset) > kBoxHalf) continue;
        along_z ? take(across, along) : take(along, across);
      }
    }
  }
  if (largest < least) return kNothing;
  return {middle + (least + largest) / 2, (largest - least) / 2};
}

AzimuthArc hidden_by_pole(const Vec3d& point, double sin_theta, double cos_theta) {
  const double distance = std::hypot(point.x(), point.z());
  if (distance < kPoleRadius) return kEverything;
  const double reach = kPoleHeight * sin_theta / cos_theta;
  const double middle = azimuth(-point.x(), -point.z());
  const double tangent = std::sqrt(distance * distance - kPoleRadius * kPoleRadius);
  if (reach >= tangent) return {middle, std::asin(std::min(1.0, kPoleRadius / distance))};
  if (reach <= distance - kPoleRadius) return kNothing;
  // where the circle of that reach enters the footprint
  return {middle, acos_within((distance * distance + reach * reach - kPoleRadius * kPoleRadius) /
                              (2 * distance * reach))};
}

AzimuthArc hidden_by_canopy(const Vec3d& point, double sin_theta, double cos_theta) {
  const double distance = std::hypot(point.x(), point.z());
  const double reach = kCanopyHeight * sin_theta / cos_theta;
  const double needed = (distance * distance + reach * reach - kCanopyRadius * kCanopyRadius) / 2;
  return {distance > 0 ? azimuth(-point.x(), -point.z()) : 0, half_arc(distance * reach, needed)};
}

// Along one axis, the stretch of the ray inside the slab.
std::pair<double, double> within_slab(double from, double step, double low, double high) {
  constexpr double kFar = 1e300;
  if (step == 0) return from > low && from < high ? std::pair(-kFar, kFar) : std::pair(kFar, -kFar);
  const double a = (low - from) / step;
  const double b = (high - from) / step;
  return {std::min(a, b), std::max(a, b)};
}

bool ray_meets_box(const Vec3d& point, const Vec3d& d) {
  const auto x = within_slab(point.x(), d.x(), -kBoxHalf, kBoxHalf);
  const auto y = within_slab(point.y(), d.y(), 0, kBoxHeight);
  const auto z = within_slab(point.z(), d.z(), -kBoxHalf, kBoxHalf);
  return std::max({x.first, y.first, z.first, 0.0}) < std::min({x.second, y.second, z.second});
}

bool ray_meets_pole(const Vec3d& point, const Vec3d& d) {
  const double a = d.x() * d.x() + d.z() * d.z();
  const double b = point.x() * d.x() + point.z() * d.z();
  const double c = point.x() * point.x() + point.z() * point.z() - kPoleRadius * kPoleRadius;
  if (c < 0) return true;
  const double discriminant = b * b - a * c;
  if (a == 0 || discriminant <= 0) return false;
  const double entry = (-b - std::sqrt(discriminant)) / a;
  return entry > 0 && entry * d.y() < kPoleHeight;
}

bool ray_meets_canopy(const Vec3d& point, const Vec3d& d) {
  const double t = kCanopyHeight / d.y();
  return std::hypot(point.x() + t * d.x(), point.z() + t * d.z()) < kCanopyRadius;
}

// Lambert's formula for the two sides that can face the point; the top never does. Edges in the ground plane
// and vertical ones add nothing: what remains is each upper edge's angle times its normal's share along +Y,
// less the same of the lower edge's, which lies in the horizon and has normal ±Y.
double sky_hidden_by_box(const Vec3d& point) {
  if (inside_box(point.x(), point.z())) return kPi;
  double sum = 0;
  for (const double side : {-kBoxHalf, kBoxHalf})
    for (const bool along_z : {false, true}) {
      const double across = side - (along_z ? point.x() : point.z());
      if (across * side >= 0) continue;  // seen from behind
      const double distance = std::abs(across);
      const double offset = along_z ? point.z() : point.x();
      const double slant = std::hypot(distance, kBoxHeight);
      const auto angle = [&](double depth) {
        return std::atan((kBoxHalf - offset) / depth) - std::atan((-kBoxHalf - offset) / depth);
      };
      sum += (angle(distance) - angle(slant) * distance / slant) / 2;
    }
  return sum;
}

// ∫ ½ sin²(elevation to which the pole reaches) dλ over its width, which is ψ → asin(sin ψ · r/d).
double sky_hidden_by_pole(const Vec3d& point) {
  const double distance = std::hypot(point.x(), point.z());
  if (distance < kPoleRadius) return kPi;
  constexpr int kSteps = 256;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double psi = kPi * ((i + 0.5) / kSteps - 0.5);
    const double sine = std::sin(psi) * kPoleRadius / distance;
    const double cosine = std::sqrt(1 - sine * sine);
    const double entry = distance * cosine - kPoleRadius * std::cos(psi);
    const double width = std::cos(psi) * kPoleRadius / distance / cosine * kPi / kSteps;
    sum += width * kPoleHeight * kPoleHeight / (2 * (kPoleHeight * kPoleHeight + entry * entry));
  }
  return sum;
}

// A disc's form factor for an element parallel to it.
double sky_hidden_by_canopy(const Vec3d& point) {
  const double l2 = point.x() * point.x() + point.z() * point.z();
  constexpr double kH2 = kCanopyHeight * kCanopyHeight;
  constexpr double kR2 = kCanopyRadius * kCanopyRadius;
  const double sum = l2 + kH2 + kR2;
  return kPi / 2 * (1 - (l2 + kH2 - kR2) / std::sqrt(sum * sum - 4 * l2 * kR2));
}

// The sphere, which touches the plane but nowhere crosses it, hides π (1/D)² · (1/D): its form factor for a
// horizontal element at distance D from its centre.
double sky_hidden_by_sphere(const Vec3d& point) {
  const double distance = std::hypot(point.norm(), 1.0);
  return kPi / (distance * distance * distance);
}

}  // namespace

std::string_view name(Occluder occluder) {
  switch (occluder) {
    case Occluder::sphere:
      return "sphere";
    case Occluder::box:
      return "box";
    case Occluder::pole:
      return "pole";
    case Occluder::canopy:
      return "canopy";
  }
  return "";
}

std::optional<Occluder> occluder_from_name(std::string_view wanted) {
  for (const Occluder occluder : kOccluders)
    if (name(occluder) == wanted) return occluder;
  return std::nullopt;
}

std::string occluder_names() {
  std::string names;
  for (const Occluder occluder : kOccluders)
    names += (names.empty() ? "" : ", ") + std::string(name(occluder));
  return names;
}

AzimuthArc hidden_arc(Occluder occluder, const Vec3d& point, double sin_theta, double cos_theta) {
  switch (occluder) {
    case Occluder::sphere:
      return hidden_by_sphere(point, sin_theta, cos_theta);
    case Occluder::box:
      return hidden_by_box(point, sin_theta, cos_theta);
    case Occluder::pole:
      return hidden_by_pole(point, sin_theta, cos_theta);
    case Occluder::canopy:
      return hidden_by_canopy(point, sin_theta, cos_theta);
  }
  return kNothing;
}

bool hides(Occluder occluder, const Vec3d& point, const Vec3d& direction) {
  switch (occluder) {
    case Occluder::sphere:
      return direction.dot(Vec3d::UnitY() - point) > point.norm() * direction.norm();
    case Occluder::box:
      return ray_meets_box(point, direction);
    case Occluder::pole:
      return ray_meets_pole(point, direction);
    case Occluder::canopy:
      return ray_meets_canopy(point, direction);
  }
  return false;
}

double hidden_of_uniform_sky(Occluder occluder, const Vec3d& point) {
  switch (occluder) {
    case Occluder::sphere:
      return sky_hidden_by_sphere(point);
    case Occluder::box:
      return sky_hidden_by_box(point);
    case Occluder::pole:
      return sky_hidden_by_pole(point);
    case Occluder::canopy:
      return sky_hidden_by_canopy(point);
  }
  return 0;
}

}  // namespace lightwell
