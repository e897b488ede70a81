// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/lens.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "lighting/field_error.h"
#include "lighting/orientation.h"
#include "lighting/polynomial.h"

namespace lightwell {
namespace {

double theta_d(const std::array<double, 4>& k, double theta) {
  const double t = theta * theta;
  return theta * (1 + t * (k[0] + t * (k[1] + t * (k[2] + t * k[3]))));
}

double theta_d_slope(const std::array<double, 4>& k, double theta) {
  const double t = theta * theta;
  return 1 + t * (3 * k[0] + t * (5 * k[1] + t * (7 * k[2] + t * 9 * k[3])));
}

// A slope near 0 would give one pixel the light of a wide angle.
constexpr double kLeastSlope = 1e-3;

// Least slope up to an angle: (θ², slope).
std::pair<double, double> least_slope(const Lens& lens, double to_rad) {
  return polynomial_minimum({1, 3 * lens.k[0], 5 * lens.k[1], 7 * lens.k[2], 9 * lens.k[3]}, 0,
                            to_rad * to_rad);
}

// Newton's step where it stays inside the bracket, bisection where it does not: cannot diverge.
double solve_theta(const std::array<double, 4>& k, double distance, double lo, double hi) {
  double theta = std::clamp(distance, lo, hi);
  for (int i = 0; i < 100; ++i) {
    const double error = theta_d(k, theta) - distance;
    (error > 0 ? hi : lo) = theta;
    double next = theta - error / theta_d_slope(k, theta);
    if (!(next >= lo && next <= hi)) next = lo + (hi - lo) / 2;
    const double step = std::abs(next - theta);
    theta = next;
    if (step <= 1e-9 * theta) break;  // Newton squares the error: what is left is below rounding
  }
  return theta;
}

// Angle of the distance θd from the centre (pixels ÷ focal). The field is monotone; what lies beyond it gets
// a root beyond it, or, where the extrapolation never comes so far, the tangent at its edge: a pixel that rounding puts
// past the edge stays there.
double theta_from_distance(const Lens& lens, double distance) {
  if (distance <= theta_d(lens.k, lens.max_theta_rad))
    return solve_theta(lens.k, distance, 0, lens.max_theta_rad);
  if (!(distance <= theta_d(lens.k, kPi))) {
    const double beyond =
        (distance - theta_d(lens.k, lens.max_theta_rad)) / theta_d_slope(lens.k, lens.max_theta_rad);
    return lens.max_theta_rad + beyond < kPi ? lens.max_theta_rad + beyond : kPi;
  }
  return solve_theta(lens.k, distance, lens.max_theta_rad, kPi);
}

Vec2d normalised(const Lens& lens, const Vec2d& pixel) {
  return (pixel - lens.center).cwiseQuotient(lens.focal);
}

// dΩ / dA in normalised coordinates: dΩ = sin θ dθ dφ and dA = θd dθd dφ.
double density(const Lens& lens, const Vec2d& m) {
  const double distance = m.norm();
  const double theta = theta_from_distance(lens, distance);
  const double ratio = distance > 1e-9 ? std::sin(theta) / distance : 1;
  return ratio / theta_d_slope(lens.k, theta);
}

// The cap's solid angle over 2π, divided by θd²: (1 − cos θ) / θd², which is smooth through the centre.
double cap_density(const Lens& lens, const Vec2d& m) {
  const double distance = m.norm();
  if (distance < 1e-9) return 0.5;
  const double s = std::sin(theta_from_distance(lens, distance) / 2) / distance;
  return 2 * s * s;
}

double cross(const Vec2d& a, const Vec2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// ∫ (1 − cos θ) dφ along the segment, all of it inside the field. dφ = (m × dm) / |m|².
double integral_inside(const Lens& lens, const Vec2d& from, const Vec2d& to) {
  constexpr double kNode[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                               0.9602898564975363};
  constexpr double kWeight[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                 0.1012285362903763};
  const Vec2d along = to - from;
  const int pieces =
      std::max(1, static_cast<int>(std::ceil(along.norm() / 0.1)));  // Gauss–Legendre, 8 nodes each
  double sum = 0;
  for (int piece = 0; piece < pieces; ++piece)
    for (int i = 0; i < 4; ++i)
      for (const double side : {-1.0, 1.0}) {
        const double s = (piece + (1 + side * kNode[i]) / 2) / pieces;
        sum += kWeight[i] / 2 * cap_density(lens, from + s * along);
      }
  return cross(from, along) * sum / pieces;
}

// The same along a segment outside the field, where the cap has stopped growing.
double integral_outside(const Lens& lens, const Vec2d& from, const Vec2d& to) {
  return (1 - std::cos(lens.max_theta_rad)) * std::atan2(cross(from, to), from.dot(to));
}

// Along any segment: split where it crosses the border circle of radius `edge`.
double integral_along(const Lens& lens, double edge, const Vec2d& from, const Vec2d& to) {
  const Vec2d along = to - from;
  const double length2 = along.squaredNorm();
  const double middle = -from.dot(along) / length2;
  const double half2 = (edge * edge - (from + middle * along).squaredNorm()) / length2;
  if (half2 <= 0) return integral_outside(lens, from, to);
  const double enter = std::clamp(middle - std::sqrt(half2), 0.0, 1.0);
  const double leave = std::clamp(middle + std::sqrt(half2), 0.0, 1.0);
  if (enter >= leave) return integral_outside(lens, from, to);
  double sum = integral_inside(lens, from + enter * along, from + leave * along);
  if (enter > 0) sum += integral_outside(lens, from, from + enter * along);
  if (leave < 1) sum += integral_outside(lens, from + leave * along, to);
  return sum;
}

}  // namespace

Vec2d Lens::project(const Vec3d& direction) const {
  const double horizontal = std::hypot(direction.x(), direction.y());
  if (horizontal == 0 && direction.z() >= 0) return center;
  const double distance = theta_d(k, std::atan2(horizontal, direction.z()));
  const Vec2d unit = horizontal > 0 ? Vec2d(direction.head<2>() / horizontal) : Vec2d(1, 0);
  return center + focal.cwiseProduct(distance * unit);
}

LensJacobian project_with_jacobian(const Lens& lens, const Vec3d& direction) {
  LensJacobian j{lens.project(direction), Eigen::Matrix<double, 2, 8>::Zero(),
                 Eigen::Matrix<double, 2, 3>::Zero()};
  j.dpixel_dlens(0, 2) = j.dpixel_dlens(1, 3) = 1;
  const double z = direction.z();
  const double h = direction.head<2>().norm();
  if (h <= 1e-9 * std::abs(z)) {  // on the axis, where θd / h is 1 / z
    if (z <= 0) return j;
    j.dpixel_ddirection(0, 0) = lens.focal.x() / z;
    j.dpixel_ddirection(1, 1) = lens.focal.y() / z;
    return j;
  }
  const double theta = std::atan2(h, z);
  const double distance = theta_d(lens.k, theta);
  const double slope = theta_d_slope(lens.k, theta);
  const Vec2d unit = direction.head<2>() / h;
  double power = theta;
  for (Eigen::Index i = 0; i < 4; ++i) {
    power *= theta * theta;
    j.dpixel_dlens.col(4 + i) = power * lens.focal.cwiseProduct(unit);
  }
  j.dpixel_dlens(0, 0) = distance * unit.x();
  j.dpixel_dlens(1, 1) = distance * unit.y();
  // Along the radius θ changes by z / |d|² a unit of h and by −h / |d|² a unit of z; across it the
  // distance stays and the azimuth turns.
  const double n2 = h * h + z * z;
  const Eigen::Matrix2d along = unit * unit.transpose();
  const Eigen::Matrix2d across = Eigen::Matrix2d::Identity() - along;
  j.dpixel_ddirection.leftCols<2>() =
      lens.focal.asDiagonal() * (slope * z / n2 * along + distance / h * across);
  j.dpixel_ddirection.col(2) = -slope * h / n2 * lens.focal.cwiseProduct(unit);
  return j;
}

Vec3d Lens::unproject(const Vec2d& pixel) const {
  const Vec2d m = normalised(*this, pixel);
  const double distance = m.norm();
  if (distance == 0) return Vec3d::UnitZ();
  const double theta = theta_from_distance(*this, distance);
  const double s = std::sin(theta) / distance;
  return {s * m.x(), s * m.y(), std::cos(theta)};
}

double Lens::theta_rad(const Vec2d& pixel) const {
  return theta_from_distance(*this, normalised(*this, pixel).norm());
}

// Green's theorem: with F(θ) = 1 − cos θ up to the border of the field and constant beyond it, the part of
// the pixel inside the field covers ∮ F dφ along the pixel's outline. Edges that two pixels share cancel
// exactly in a sum. Small pixels wholly inside take the cheaper 2 × 2 Gauss–Legendre rule of the Jacobian,
// whose relative error is of the order (side in radians)⁴ / 4320, below 1e-9.
double Lens::pixel_solid_angle_sr(const Vec2d& pixel) const {
  const double edge = theta_d(k, max_theta_rad);
  const Vec2d m = normalised(*this, pixel);
  const Vec2d half = Vec2d::Constant(0.5).cwiseQuotient(focal);
  const Vec2d nearest = (m.cwiseAbs() - half).cwiseMax(0.0);
  if (nearest.norm() >= edge) return 0;
  if ((m.cwiseAbs() + half).norm() < edge && half.maxCoeff() < 0.02) {
    const Vec2d node = half / std::sqrt(3.0);
    double sum = 0;
    for (const double sx : {-1.0, 1.0})
      for (const double sy : {-1.0, 1.0}) sum += density(*this, m + Vec2d(sx * node.x(), sy * node.y()));
    return sum * half.x() * half.y();
  }
  const Vec2d corner[4] = {m + Vec2d(-half.x(), -half.y()), m + Vec2d(half.x(), -half.y()), m + half,
                           m + Vec2d(-half.x(), half.y())};
  double sum = 0;
  for (int i = 0; i < 4; ++i) sum += integral_along(*this, edge, corner[i], corner[(i + 1) % 4]);
  return std::max(0.0, sum);
}

Status check(const Lens& lens) {
  for (std::size_t i = 0; i < 2; ++i) {
    const std::string index = "[" + std::to_string(i) + "]";
    const auto axis = static_cast<Eigen::Index>(i);
    if (lens.image_size[i] < 1 || lens.image_size[i] > 16384)
      return field_error("lens.image_size" + index, lens.image_size[i], "1 to 16384 pixels");
    if (!(lens.focal[axis] > 0 && lens.focal[axis] < 1e6))
      return field_error("lens.focal" + index, lens.focal[axis], "above 0, below 1e6 pixels a radian");
    if (!(std::abs(lens.center[axis]) < 1e6))
      return field_error("lens.center" + index, lens.center[axis], "-1e6 to 1e6 pixels");
  }
  for (std::size_t i = 0; i < 4; ++i)
    if (!(std::abs(lens.k[i]) < 1e6))
      return field_error("lens.k[" + std::to_string(i) + "]", lens.k[i], "-1e6 to 1e6");
  if (!(lens.max_theta_rad > 0 && lens.max_theta_rad <= kPi))
    return field_error("lens.max_theta_rad", lens.max_theta_rad, "above 0, at most pi");
  const auto [t, slope] = least_slope(lens, lens.max_theta_rad);
  if (slope < kLeastSlope)
    return field_error(
        "lens.k: slope of the projection at " + std::to_string(std::sqrt(t) * 180 / kPi) + " degrees", slope,
        "at least 0.001 up to max_theta_rad");
  return check_zenith(lens.zenith);
}

// The least slope up to an angle falls with that angle.
double increasing_to_rad(const Lens& lens) {
  double lo = 0, hi = kPi;
  if (least_slope(lens, hi).second >= kLeastSlope) return hi;
  for (int i = 0; i < 50; ++i) {
    const double middle = (lo + hi) / 2;
    (least_slope(lens, middle).second >= kLeastSlope ? lo : hi) = middle;
  }
  return lo;
}

}  // namespace lightwell
