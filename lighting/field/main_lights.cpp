// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/main_lights.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "lighting/fit/nonnegative_least_squares.h"

namespace lightwell {
namespace {

constexpr std::size_t kMostAsked = 2000;  // points that are asked for directions
constexpr int kDirections = 642;          // that are tried: 8 degrees apart

// Luminance of harmonics: [harmonic][point].
Eigen::MatrixXd asked_points(const LightField& field, const Vec3d& low, const Vec3d& high) {
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
  const auto count = static_cast<Eigen::Index>(std::min(asked.size(), kMostAsked));
  const auto index_of = [&](Eigen::Index p) {
    if (asked.size() <= kMostAsked) return static_cast<std::size_t>(p);
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

// An ambient term of radiance 1 and lights of illuminance 1 as columns of harmonics.
class Basis {
 public:
  Basis(const std::vector<Vec3d>& directions, int degree)
      : columns_(
            Eigen::MatrixXd::Zero(harmonic_count(degree), 1 + static_cast<Eigen::Index>(directions.size()))) {
    columns_(0, 0) = std::sqrt(4 * kPi);
    for (std::size_t i = 0; i < directions.size(); ++i)
      harmonics(directions[i], degree, columns_.col(1 + static_cast<Eigen::Index>(i)).data());
    gram_ = columns_.transpose() * columns_;
  }
  // point: [harmonic]
  template <class Point>
  [[nodiscard]] SmallVector powers(const Point& point) const {
    const SmallVector right = columns_.transpose() * point;
    return solve_nonnegative(gram_, right).x;
  }
  [[nodiscard]] const Eigen::MatrixXd& columns() const { return columns_; }

 private:
  Eigen::MatrixXd columns_;
  SmallMatrix gram_;
};

// What an ambient term and lights in these directions leave of the points: [harmonic][point].
Eigen::MatrixXd residual_of(const Eigen::MatrixXd& points, const std::vector<Vec3d>& directions, int degree) {
  const Basis basis(directions, degree);
  Eigen::MatrixXd residual = points;
  for (Eigen::Index p = 0; p < points.cols(); ++p)
    residual.col(p) -= basis.columns() * basis.powers(points.col(p));
  return residual;
}

// How much of the residual a light there would explain: squares of the positive radiance in that direction.
double gain(const Eigen::MatrixXd& residual, const Vec3d& direction, int degree) {
  Eigen::VectorXd y(harmonic_count(degree));
  harmonics(direction, degree, y.data());
  return (y.transpose() * residual).cwiseMax(0.0).squaredNorm();
}

// Of a light there that alone explains it, summed over points: ‖Y‖² of a direction is (degree + 1)²/4π.
double illuminance_from(const Eigen::MatrixXd& residual, const Vec3d& direction, int degree) {
  Eigen::VectorXd y(harmonic_count(degree));
  harmonics(direction, degree, y.data());
  return (y.transpose() * residual).cwiseMax(0.0).sum() / y.squaredNorm();
}

// Uphill by steps around the direction, from 8 degrees to a tenth of one.
Vec3d refined(const Eigen::MatrixXd& residual, Vec3d direction, int degree) {
  double best = gain(residual, direction, degree);
  for (double step_rad = 0.07; step_rad > 0.0017; step_rad /= 2)
    for (bool moved = true; moved;) {
      moved = false;
      const Vec3d u = direction.unitOrthogonal(), v = direction.cross(u);
      for (int k = 0; k < 6; ++k) {
        const double around = kPi / 3 * k;
        const Vec3d tried =
            (direction + step_rad * (std::cos(around) * u + std::sin(around) * v)).normalized();
        if (const double here = gain(residual, tried, degree); here > best * (1 + 1e-9)) {
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
    if (const double here = gain(residual, d, degree); here > most) {
      most = here;
      best = d;
    }
  }
  return refined(residual, best, degree);
}

std::vector<Vec3d> find_directions(const Eigen::MatrixXd& points, int count, int degree) {
  std::vector<Vec3d> directions;
  // The points' light: of radiance L from everywhere it is 4π L, and the first harmonic √4π L.
  const double total = std::sqrt(4 * kPi) * points.row(0).cwiseMax(0.0).sum();
  if (!(total > 0)) return directions;
  while (static_cast<int>(directions.size()) < count) {
    const Eigen::MatrixXd residual = residual_of(points, directions, degree);
    const Vec3d next = brightest(residual, degree);
    if (illuminance_from(residual, next, degree) < kLeastMainLight * total) break;
    directions.push_back(next);
    // Each where it explains most of what the others leave.
    for (int round = 0; round < 2; ++round)
      for (std::size_t i = 0; i < directions.size(); ++i) {
        std::vector<Vec3d> others = directions;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
        directions[i] = refined(residual_of(points, others, degree), directions[i], degree);
      }
  }
  return directions;
}

}  // namespace

const float* MainLights::plane(int light, int z, int channel, const FieldGrid& grid) const {
  const auto slab = static_cast<std::size_t>(grid.size[0]) * static_cast<std::size_t>(grid.size[1]);
  return &illuminance[((static_cast<std::size_t>(light) * static_cast<std::size_t>(grid.size[2]) +
                        static_cast<std::size_t>(z)) *
                           3 +
                       static_cast<std::size_t>(channel)) *
                      slab];
}

MainLights find_main_lights(const LightField& field, int count, const Vec3d& low, const Vec3d& high) {
  MainLights lights;
  if (count > 0)
    lights.directions =
        find_directions(asked_points(field, low, high), std::min(count, kMostMainLights), field.degree);
  const FieldGrid& grid = field.grid;
  const std::size_t slab = field.slab_points(), number = lights.directions.size();
  lights.illuminance.assign(number * 3 * grid.points(), 0.0f);
  if (number == 0) return lights;
  const Basis basis(lights.directions, field.degree);
  Eigen::VectorXd point(field.harmonics());
  for (int z = 0; z < grid.size[2]; ++z)
    for (int c = 0; c < 3; ++c)
      for (std::size_t at = 0; at < slab; ++at) {
        for (int h = 0; h < field.harmonics(); ++h) point[h] = static_cast<double>(field.plane(z, h, c)[at]);
        const SmallVector x = basis.powers(point);
        for (std::size_t i = 0; i < number; ++i)
          lights.illuminance[((i * static_cast<std::size_t>(grid.size[2]) + static_cast<std::size_t>(z)) * 3 +
                              static_cast<std::size_t>(c)) *
                                 slab +
                             at] = static_cast<float>(x[1 + static_cast<Eigen::Index>(i)]);
      }
  return lights;
}

}  // namespace lightwell
