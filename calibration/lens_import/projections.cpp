// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/lens_import/projections.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lighting/polynomial.h"

namespace lightwell::calibration {
namespace {

Vec2d on_plane(const PinholePlane& plane, const Vec2d& m) {
  return plane.focal.cwiseProduct(m) + plane.center;
}

// What a unified model can see: directions with z above -w |p| (Usenko et al., section 3).
double seen_from(double alpha) {
  return alpha <= 0.5 ? alpha / (1 - alpha) : (1 - alpha) / alpha;
}

// Stereographic coordinates: 2 tan(θ / 2) along (x, y).
std::optional<Vec2d> stereographic_plane(const Vec3d& d) {
  const double below = d.norm() + d.z();
  if (!(below > 1e-12 * d.norm())) return {};
  return Vec2d(2 * d.head<2>() / below);
}

// Weights of a uniform B-spline's control points at x: cubic, x in [0, 1] between the second and third of four;
// quadratic, x in [-1/2, 1/2] around the second of three.
std::array<double, 4> spline_weights(int order, double x) {
  if (order == 3) {
    const double y = 1 - x;
    return {y * y * y / 6, (4 - 6 * x * x + 3 * x * x * x) / 6, (4 - 6 * y * y + 3 * y * y * y) / 6,
            x * x * x / 6};
  }
  return {(0.5 - x) * (0.5 - x) / 2, 0.75 - x * x, (0.5 + x) * (0.5 + x) / 2, 0};
}

// First control point that counts at place x of n, and the weights from there on.
std::pair<int, std::array<double, 4>> spline_at(int order, double x, int n) {
  const int knot = static_cast<int>(std::floor(order == 3 ? x : x + 0.5));
  const int inside = std::clamp(knot, 1, order == 3 ? n - 3 : n - 2);
  return {inside - 1, spline_weights(order, x - inside)};
}

}  // namespace

Vec2d distorted(const PlaneDistortion& k, const Vec2d& m) {
  const double x = m.x(), y = m.y(), r2 = m.squaredNorm();
  const double radial =
      (1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) / (1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
  return {x * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x) + r2 * (k[8] + r2 * k[9]),
          y * radial + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y + r2 * (k[10] + r2 * k[11])};
}

Projection perspective(const PinholePlane& plane, const PlaneDistortion& k) {
  return [=](const Vec3d& d) -> std::optional<Vec2d> {
    if (!(d.z() > 0)) return {};
    return on_plane(plane, distorted(k, d.head<2>() / d.z()));
  };
}

Projection field_of_view(const PinholePlane& plane, double w) {
  return [=](const Vec3d& d) -> std::optional<Vec2d> {
    const double r = d.head<2>().norm();
    if (!(d.z() > 0)) return {};
    if (r == 0) return plane.center;
    return on_plane(plane, std::atan2(2 * r * std::tan(w / 2), d.z()) / w * d.head<2>() / r);
  };
}

Projection equidistant(const PinholePlane& plane, const std::array<double, 4>& k) {
  return [=](const Vec3d& d) -> std::optional<Vec2d> {
    const double r = d.head<2>().norm();
    if (r == 0) return d.z() > 0 ? std::optional(plane.center) : std::nullopt;
    const double theta = std::atan2(r, d.z());
    const double t3 = theta * theta * theta, t5 = t3 * theta * theta, t7 = t5 * theta * theta;
    const double theta_d = theta + k[0] * t3 + k[1] * t5 + k[2] * t7 + k[3] * t7 * theta * theta;
    return on_plane(plane, theta_d / r * d.head<2>());
  };
}

Projection stereographic(const PinholePlane& plane) {
  return [=](const Vec3d& d) -> std::optional<Vec2d> {
    const auto u = stereographic_plane(d);
    if (!u) return {};
    return on_plane(plane, *u);
  };
}

Projection omnidirectional(const PinholePlane& plane, double xi, const PlaneDistortion& k) {
  const double w = xi <= 1 ? xi : 1 / xi;
  return [=](const Vec3d& d) -> std::optional<Vec2d> {
    const double length = d.norm();
    if (!(d.z() > -w * length)) return {};
    return on_plane(plane, distorted(k, d.head<2>() / (d.z() + xi * length)));
  };
}

Projection enhanced_unified(const PinholePlane& plane, double alpha, double beta) {
  const double w = seen_from(alpha);
  return [=](const Vec3d& d) -> std::optional<Vec2d> {
    const double length = std::sqrt(beta * d.head<2>().squaredNorm() + d.z() * d.z());
    if (!(d.z() > -w * length)) return {};
    return on_plane(plane, d.head<2>() / (alpha * length + (1 - alpha) * d.z()));
  };
}

Projection double_sphere(const PinholePlane& plane, double xi, double alpha) {
  const double w1 = seen_from(alpha);
  const double w2 = (w1 + xi) / std::sqrt(2 * w1 * xi + xi * xi + 1);
  return [=](const Vec3d& d) -> std::optional<Vec2d> {
    const double d1 = d.norm();
    if (!(d.z() > -w2 * d1)) return {};
    const double z = xi * d1 + d.z();
    const double d2 = std::hypot(d.head<2>().norm(), z);
    return on_plane(plane, d.head<2>() / (alpha * d2 + (1 - alpha) * z));
  };
}

Projection cahvor(const PinholePlane& plane, const std::array<double, 5>& p) {
  const Vec3d axis(std::sin(p[0]) * std::cos(p[1]), std::sin(p[1]), std::cos(p[0]) * std::cos(p[1]));
  return [=](const Vec3d& d) -> std::optional<Vec2d> {
    const double along = d.dot(axis);
    if (!(along > 0)) return {};
    const double tau = d.squaredNorm() / (along * along) - 1;
    const double mu = p[2] + tau * (p[3] + tau * p[4]);
    const Vec3d moved = d + mu * (d - along * axis);
    if (!(moved.z() > 0)) return {};
    return on_plane(plane, moved.head<2>() / moved.z());
  };
}

Projection splined_stereographic(SplinedStereographic model) {
  // The last knots lie past the edge, by half an interval (quadratic) or a whole one (cubic) on either side.
  const double edge = 2 * std::tan(model.fov_x_deg / 4 * kPi / 180);
  const double knots_per_u = (model.nx - 1 - (model.order == 2 ? 1 : 2)) / (2 * edge);
  return [=, m = std::move(model)](const Vec3d& d) -> std::optional<Vec2d> {
    const auto u = stereographic_plane(d);
    if (!u) return {};
    const Vec2d place = knots_per_u * *u + Vec2d(m.nx - 1, m.ny - 1) / 2;
    if (!(place.cwiseAbs().maxCoeff() < 1e6)) return {};
    const auto [x0, wx] = spline_at(m.order, place.x(), m.nx);
    const auto [y0, wy] = spline_at(m.order, place.y(), m.ny);
    Vec2d moved = *u;
    for (int j = 0; j <= m.order; ++j)
      for (int i = 0; i <= m.order; ++i) {
        const auto at = 2 * (static_cast<std::size_t>(y0 + j) * static_cast<std::size_t>(m.nx) +
                             static_cast<std::size_t>(x0 + i));
        const double weight = wx[static_cast<std::size_t>(i)] * wy[static_cast<std::size_t>(j)];
        moved += weight * Vec2d(m.control[at], m.control[at + 1]);
      }
    return on_plane(m.plane, moved);
  };
}

Projection ocam(OcamModel model) {
  const auto theta_of = [poly = model.polynomial](double rho) {
    return std::atan2(rho, -polynomial_value(poly, rho));
  };
  // The model ends where the angle stops growing with the distance.
  constexpr int kSteps = 1024;
  double end = 0;
  for (int i = 1; i <= kSteps; ++i) {
    const double rho = model.largest_rho * i / kSteps;
    if (!(theta_of(rho) > theta_of(end))) break;
    end = rho;
  }
  return [=, m = std::move(model)](const Vec3d& d) -> std::optional<Vec2d> {
    const double r = d.head<2>().norm();
    const double theta = std::atan2(r, d.z());
    if (theta > theta_of(end)) return {};
    double lo = 0, hi = end;
    for (int i = 0; i < 60; ++i) {
      const double middle = (lo + hi) / 2;
      (theta_of(middle) < theta ? lo : hi) = middle;
    }
    const Vec2d row_column = r > 0 ? Vec2d(lo / r * Vec2d(d.y(), d.x())) : Vec2d(0, 0);
    const double row = m.c * row_column.x() + m.d * row_column.y() + m.center_row_column.x();
    const double column = m.e * row_column.x() + row_column.y() + m.center_row_column.y();
    return Vec2d(column, row);
  };
}

}  // namespace lightwell::calibration
