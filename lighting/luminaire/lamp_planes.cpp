// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/luminaire/lamp_planes.h"

#include <algorithm>
#include <cmath>

namespace lightwell {

// With y = 1 − x for the two right-hand weights.
std::array<double, 4> cubic_weights(double x) noexcept {
  const double y = 1 - x;
  return {-0.5 * x * y * y, 1 + x * x * (1.5 * x - 2.5), 1 + y * y * (1.5 * y - 2.5), -0.5 * y * x * x};
}

Vec2d square_from_direction(const Vec3d& direction) {
  const double radius = std::sqrt(std::clamp(1 + direction.z(), 0.0, 1.0));
  double turn = std::atan2(direction.y(), direction.x());  // from −45° on, a quarter of the square each
  if (turn < -kPi / 4) turn += 2 * kPi;
  const int quarter = std::min(static_cast<int>((turn + kPi / 4) / (kPi / 2)), 3);
  const double along = radius * (turn - quarter * kPi / 2) / (kPi / 4);
  switch (quarter) {
    case 0:
      return {radius, along};
    case 1:
      return {-along, radius};
    case 2:
      return {-radius, -along};
    default:
      return {along, -radius};
  }
}

Vec3d direction_from_square(const Vec2d& place) {
  const double x = place.x(), y = place.y();
  if (x == 0 && y == 0) return -Vec3d::UnitZ();
  const bool beside = std::abs(x) >= std::abs(y);
  const double radius = beside ? x : y;
  const double turn = beside ? kPi / 4 * (y / x) : kPi / 2 - kPi / 4 * (x / y);
  const double sine = radius * std::sqrt(2 - radius * radius);  // cos = 1 − r²
  return {sine * std::cos(turn), sine * std::sin(turn), radius * radius - 1};
}

Vec2d LampPlanes::on_map(const Vec2d& sampling, const Vec3d& way) const {
  if (map == LampMap::hemisphere) return square_from_direction(way.normalized());
  return sampling + way.head<2>() * (distance_m / -way.z());
}

double LampPlanes::pixel_solid_angle_sr(const Vec2d& sampling, int s, int t) const {
  const double area = pixel_m().prod();
  if (map == LampMap::hemisphere) return area / 4 * 2 * kPi;
  const double square = distance_m * distance_m + (pixel_centre(s, t) - sampling).squaredNorm();
  return area * distance_m / (square * std::sqrt(square));
}

Rgbd LampImages::at(int u, int v, const Vec2d& measurement) const {
  if (!(measurement.array() >= planes.low_m.array()).all() ||
      !(measurement.array() <= planes.high_m.array()).all())
    return Rgbd::Zero();
  const Vec2d place = (measurement - planes.low_m).cwiseQuotient(planes.pixel_m()).array() - 0.5;
  const Rgb* pixels = image(u, v);
  const auto [width, height] = planes.pixels;
  const Vec2d corner = place.array().floor();
  const auto across = cubic_weights(place.x() - corner.x()), down = cubic_weights(place.y() - corner.y());
  Rgbd sum = Rgbd::Zero();
  for (int j = 0; j < 4; ++j) {
    const int row = std::clamp(static_cast<int>(corner.y()) + j - 1, 0, height - 1);
    Rgbd of_row = Rgbd::Zero();
    for (int i = 0; i < 4; ++i) {
      const int column = std::clamp(static_cast<int>(corner.x()) + i - 1, 0, width - 1);
      of_row += across[static_cast<std::size_t>(i)] *
                pixels[static_cast<std::ptrdiff_t>(row) * width + column].cast<double>();
    }
    sum += down[static_cast<std::size_t>(j)] * of_row;
  }
  return sum;
}

}  // namespace lightwell
