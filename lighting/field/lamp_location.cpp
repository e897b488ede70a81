// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/lamp_location.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace lightwell {
namespace {

using Matrix32 = Eigen::Matrix<double, 3, 2>;

constexpr int kSteps = 20;
constexpr double kNormal95 = 1.959964;  // standard deviations about the mean that hold 95 %

// Two unit vectors across a direction.
Matrix32 across(const Vec3d& direction) {
  Matrix32 axes;
  axes.col(0) = direction.unitOrthogonal();
  axes.col(1) = direction.cross(axes.col(0));
  return axes;
}

struct Equations {
  Eigen::Matrix3d normal =
      Eigen::Matrix3d::Zero();  // of two turns of the direction, and of the inverse distance
  Vec3d right = Vec3d::Zero();
  double squares = 0;  // rad²
  bool ahead = true;   // of every ray
};

Equations equations_at(std::span<const SightRay> rays, const Vec3d& direction, double inverse) {
  Equations sum;
  const Matrix32 turn = across(direction);
  for (const SightRay& ray : rays) {
    const Vec3d base = rays.front().origin - ray.origin;
    const Vec3d toward = direction + inverse * base;
    const double length = std::max(toward.norm(), 1e-12);
    const Vec3d unit = toward / length;
    if (!(unit.dot(ray.direction) > 0)) sum.ahead = false;
    // The angle between ray and place as a vector across the ray: the arc, not its sine, for rays that err much.
    const Matrix32 axes = across(ray.direction);
    const Vec2d sine = axes.transpose() * unit;
    const double arc = std::atan2(sine.norm(), unit.dot(ray.direction));
    const Vec2d residual = sine.norm() > 0 ? Vec2d(sine * (arc / sine.norm())) : Vec2d(Vec2d::Zero());
    Eigen::Matrix3d turned;
    turned.leftCols<2>() = turn;
    turned.col(2) = base;
    const Eigen::Matrix<double, 2, 3> jacobian =
        axes.transpose() * (Eigen::Matrix3d::Identity() - unit * unit.transpose()) * turned / length;
    sum.normal += jacobian.transpose() * jacobian;
    sum.right -= jacobian.transpose() * residual;
    sum.squares += residual.squaredNorm();
  }
  return sum;
}

// Rays' least squares in space: good where they cross at an angle; none where that is behind.
std::optional<Vec3d> crossing(std::span<const SightRay> rays) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Vec3d right = Vec3d::Zero();
  for (const SightRay& ray : rays) {
    const Eigen::Matrix3d project = Eigen::Matrix3d::Identity() - ray.direction * ray.direction.transpose();
    normal += project;
    right += project * ray.origin;
  }
  const Eigen::LDLT<Eigen::Matrix3d> factors(normal);
  if (factors.info() != Eigen::Success || !(factors.rcond() > 1e-9)) return std::nullopt;
  const Vec3d place = factors.solve(right);
  const bool ahead = std::all_of(rays.begin(), rays.end(), [&](const SightRay& ray) {
    return (place - ray.origin).dot(ray.direction) > 0;
  });
  return place.allFinite() && ahead ? std::optional(place) : std::nullopt;
}

// Of the inverse distance, with the direction free: what the rays say of it. 1 / variance of rays that err by one radian.
double distance_information(const Eigen::Matrix3d& normal) {
  const Eigen::Matrix2d turns = normal.topLeftCorner<2, 2>();
  const Vec2d mixed = normal.topRightCorner<2, 1>();
  return normal(2, 2) - mixed.dot(turns.ldlt().solve(mixed));
}

}  // namespace

LampLocation::Range LampLocation::distance() const {
  Range range;
  if (!std::isfinite(inverse_sigma)) return range;
  const double most = inverse_distance + kNormal95 * inverse_sigma,
               least = inverse_distance - kNormal95 * inverse_sigma;
  if (most > 0)
    range.near_m = 1 / most;
  else
    range.near_m = range.far_m;
  if (least > 0) range.far_m = 1 / least;
  return range;
}

std::optional<LampLocation> locate_lamp(std::span<const SightRay> rays, double sigma_rad) {
  if (rays.empty()) return std::nullopt;
  double base_m = 0;  // the unit of length: the problem has the same numbers whatever its size
  for (const SightRay& ray : rays) base_m = std::max(base_m, (ray.origin - rays.front().origin).norm());
  LampLocation lamp;
  lamp.direction = rays.front().direction;
  if (base_m > 0)
    if (const auto guess = crossing(rays)) {
      const Vec3d toward = *guess - rays.front().origin;
      lamp.direction = toward.normalized();
      lamp.inverse_distance = 1 / toward.norm();
    }
  Equations sum = equations_at(rays, lamp.direction, lamp.inverse_distance);
  double damping = 0;
  for (int step = 0; step < kSteps; ++step) {
    Eigen::Matrix3d normal = sum.normal;
    normal(2, 2) +=
        1e-12 * base_m * base_m + (base_m > 0 ? 0.0 : 1.0);  // where the distance is not determined
    normal.diagonal() *= 1 + damping;
    const Vec3d change = normal.ldlt().solve(sum.right);
    const Vec3d direction = (lamp.direction + across(lamp.direction) * change.head<2>()).normalized();
    const double inverse = lamp.inverse_distance + change.z();
    const Equations next = equations_at(rays, direction, inverse);
    if (!(next.squares <= sum.squares)) {
      damping = std::max(10 * damping, 1e-3);
      continue;
    }
    const bool still = change.head<2>().norm() < 1e-12 && std::abs(change.z()) * base_m < 1e-12;
    lamp.direction = direction;
    lamp.inverse_distance = inverse;
    sum = next;
    damping /= 10;
    if (still) break;
  }
  if (!sum.ahead || !lamp.direction.allFinite()) return std::nullopt;
  lamp.degrees_of_freedom = std::max(2 * static_cast<int>(rays.size()) - 3, 0);
  lamp.chi_square = sum.squares / (sigma_rad * sigma_rad);
  const double scatter =
      lamp.degrees_of_freedom > 0 ? std::max(1.0, lamp.chi_square / lamp.degrees_of_freedom) : 1.0;
  const double variance = sigma_rad * sigma_rad * scatter;
  const double information = distance_information(sum.normal);
  // Of origins in one place, or all in the line toward the lamp, rounding is left.
  const bool known = information > 1e-12 * base_m * base_m;
  lamp.inverse_sigma = known ? std::sqrt(variance / information) : std::numeric_limits<double>::infinity();
  if (lamp.is_near()) {
    lamp.position = rays.front().origin + lamp.direction / lamp.inverse_distance;
    Eigen::Matrix3d moves;
    moves.leftCols<2>() = across(lamp.direction) / lamp.inverse_distance;
    moves.col(2) = -lamp.direction / (lamp.inverse_distance * lamp.inverse_distance);
    lamp.covariance = moves * (variance * sum.normal.inverse()) * moves.transpose();
  }
  return lamp;
}

}  // namespace lightwell
