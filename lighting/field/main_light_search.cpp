// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/main_light_search.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace lightwell {
namespace {

constexpr int kDirections = 642;  // that are tried: 8 degrees apart
constexpr double kLastStep_rad = 0.0017;

Eigen::VectorXd harmonics_of(const Vec3d& direction, int degree) {
  Eigen::VectorXd y(harmonic_count(degree));
  harmonics(direction, degree, y.data());
  return y;
}

}  // namespace

Eigen::MatrixXd points_in_box(const LightField& field, const Vec3d& low, const Vec3d& high,
                              std::size_t most) {
  const FieldGrid& grid = field.grid;
  std::vector<std::array<int, 3>> inside, all;
  for (int k = 0; k < grid.size[2]; ++k)
    for (int j = 0; j < grid.size[1]; ++j)
      for (int i = 0; i < grid.size[0]; ++i) {
        const Vec3d p = grid.position(i, j, k);
        all.push_back({i, j, k});
        if ((p.array() >= low.array()).all() && (p.array() <= high.array()).all())
          inside.push_back(all.back());
      }
  const auto& asked = inside.empty() ? all : inside;
  // Too many: by steps of the golden section, which no row or slab of the grid is in step with.
  const auto count = static_cast<Eigen::Index>(std::min(asked.size(), most));
  const auto index_of = [&](Eigen::Index p) {
    if (asked.size() <= most) return static_cast<std::size_t>(p);
    const double turn = 0.6180339887498949 * (static_cast<double>(p) + 0.5);
    return static_cast<std::size_t>((turn - std::floor(turn)) * static_cast<double>(asked.size()));
  };
  Eigen::MatrixXd points(field.harmonics(), count);
  for (Eigen::Index p = 0; p < count; ++p) {
    const auto& [i, j, k] = asked[index_of(p)];
    const auto at = static_cast<std::size_t>(j * grid.size[0] + i);
    for (int h = 0; h < field.harmonics(); ++h)
      points(h, p) = luminance(Rgbd(static_cast<double>(field.plane(k, h, 0)[at]),
                                    static_cast<double>(field.plane(k, h, 1)[at]),
                                    static_cast<double>(field.plane(k, h, 2)[at])));
  }
  return points;
}

double total_of(const Eigen::MatrixXd& points) {
  // Radiance L from everywhere is 4π L, and its first harmonic √4π L.
  return std::sqrt(4 * kPi) * points.row(0).cwiseMax(0.0).sum();
}

MainLightBasis::MainLightBasis(std::span<const Vec3d> directions, int degree, std::span<const double> weights)
    : columns_(
          Eigen::MatrixXd::Zero(harmonic_count(degree), 1 + static_cast<Eigen::Index>(directions.size()))) {
  columns_(0, 0) = std::sqrt(4 * kPi);
  for (std::size_t i = 0; i < directions.size(); ++i)
    columns_.col(1 + static_cast<Eigen::Index>(i)) = harmonics_of(directions[i], degree);
  gram_ = columns_.transpose() * columns_;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const auto at = 1 + static_cast<Eigen::Index>(i);
    gram_(at, at) /= weights[i];
  }
}

Eigen::MatrixXd MainLightBasis::powers(const Eigen::MatrixXd& points) const {
  const Eigen::MatrixXd right = columns_.transpose() * points;
  // Where plain least squares are not negative, they are the non-negative ones.
  Eigen::MatrixXd x = gram_.ldlt().solve(right);
  unsigned free = 0;
  for (Eigen::Index p = 0; p < x.cols(); ++p) {
    if ((x.col(p).array() >= 0).all()) continue;
    const NonnegativeSolution solution = solve_nonnegative(gram_, right.col(p), free);
    free = solution.positive;  // the next point's are mostly the same
    x.col(p) = solution.x;
  }
  return x;
}

Eigen::MatrixXd MainLightBasis::residual(const Eigen::MatrixXd& points) const {
  return points - columns_ * powers(points);
}

double explained_by(const Eigen::MatrixXd& residual, const Vec3d& direction, int degree) {
  return (harmonics_of(direction, degree).transpose() * residual).cwiseMax(0.0).squaredNorm();
}

double illuminance_from(const Eigen::MatrixXd& residual, const Vec3d& direction, int degree) {
  // ‖Y‖² of a direction is (degree + 1)²/4π.
  const Eigen::VectorXd y = harmonics_of(direction, degree);
  return (y.transpose() * residual).cwiseMax(0.0).sum() / y.squaredNorm();
}

Vec3d refined(const Eigen::MatrixXd& residual, Vec3d direction, int degree, double first_step_rad) {
  double best = explained_by(residual, direction, degree);
  for (double step_rad = first_step_rad; step_rad > kLastStep_rad; step_rad /= 2)
    for (bool moved = true; moved;) {
      moved = false;
      const Vec3d u = direction.unitOrthogonal(), v = direction.cross(u);
      for (int k = 0; k < 6; ++k) {
        const double around = kPi / 3 * k;
        const Vec3d tried =
            (direction + step_rad * (std::cos(around) * u + std::sin(around) * v)).normalized();
        if (const double here = explained_by(residual, tried, degree); here > best * (1 + 1e-9)) {
          best = here;
          direction = tried;
          moved = true;
          break;
        }
      }
    }
  return direction;
}

Vec3d brightest(const Eigen::MatrixXd& residual, int degree) {
  Vec3d best = Vec3d::UnitY();
  double most = -1;
  for (int i = 0; i < kDirections; ++i) {  // a Fibonacci spiral
    const double y = 1 - 2 * (i + 0.5) / kDirections, azimuth = kPi * (3 - std::sqrt(5.0)) * i;
    const double r = std::sqrt(1 - y * y);
    const Vec3d d(r * std::sin(azimuth), y, r * std::cos(azimuth));
    if (const double here = explained_by(residual, d, degree); here > most) {
      most = here;
      best = d;
    }
  }
  return refined(residual, best, degree, 0.07);
}

std::vector<float> illuminances(const LightField& field, const MainLightBasis& basis, std::size_t lights) {
  const auto slab = static_cast<Eigen::Index>(field.slab_points());
  std::vector<float> lux(lights * 3 * field.grid.points());
  if (lights == 0) return lux;
  const auto depth = static_cast<std::size_t>(field.grid.size[2]);
  for (int z = 0; z < field.grid.size[2]; ++z)
    for (int c = 0; c < 3; ++c) {
      const Eigen::Map<const Eigen::MatrixXf, 0, Eigen::OuterStride<>> points(
          field.plane(z, 0, c), slab, field.harmonics(), Eigen::OuterStride<>(3 * slab));
      const Eigen::MatrixXd x = basis.powers(points.transpose().cast<double>());
      for (std::size_t i = 0; i < lights; ++i) {
        float* const out =
            &lux[((i * depth + static_cast<std::size_t>(z)) * 3 + static_cast<std::size_t>(c)) *
                 field.slab_points()];
        Eigen::Map<Eigen::RowVectorXf>(out, slab) =
            x.row(1 + static_cast<Eigen::Index>(i))
                .cwiseMin(static_cast<double>(std::numeric_limits<float>::max()))
                .cast<float>();
      }
    }
  return lux;
}

}  // namespace lightwell
