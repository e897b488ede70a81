// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "lighting/direction.h"
#include "lighting/field/direction_estimator.h"

// Fields of light in the unit cube whose radiance is known everywhere, and what a take of probes makes of them in memory.
namespace lightwell::test {

using AnalyticField = std::function<Rgbd(const Vec3d& at, const Vec3d& toward)>;

// Linear across every direction and constant along it, as light in empty space is.
inline Rgbd linear_field(const Vec3d& at, const Vec3d& toward) {
  const Vec3d slope(0.6, -0.3, 0.4), other(-0.2, 0.5, 0.3);
  const Vec3d across = at - Vec3d(0.5, 0.5, 0.5) - toward * toward.dot(at - Vec3d(0.5, 0.5, 0.5));
  return {1 + slope.dot(across), 1 + 0.5 * toward.y() + other.dot(across), 1.0};
}

// 1 inside, 0 outside, over an edge of this width.
inline double soft_step(double inside, double width) {
  const double t = std::clamp(inside / width + 0.5, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

// A room of 3 m whose walls shine a little, unevenly, and two lamps of soft edges in its ceiling, 1 m above the cube.
inline Rgbd box_of_lamps(const Vec3d& at, const Vec3d& toward) {
  const Vec3d low(-1, -1, -1), high(2, 2, 2);
  double t = 1e30;
  for (int a = 0; a < 3; ++a)
    if (toward[a] != 0) t = std::min(t, ((toward[a] > 0 ? high[a] : low[a]) - at[a]) / toward[a]);
  const Vec3d wall = at + t * toward;
  const double pattern = 1 + 0.5 * std::sin(2 * wall.x()) * std::cos(2 * wall.y() + wall.z());
  Rgbd radiance = Rgbd(1, 0.8, 0.6) * pattern;
  const auto lamp = [&](double x, double z, double half) {
    return soft_step(half - std::abs(wall.x() - x), 0.25) * soft_step(half - std::abs(wall.z() - z), 0.25);
  };
  if (wall.y() > 2 - 1e-9)
    radiance += 40 * lamp(-0.2, 0.2, 0.3) * Rgbd(1, 0.9, 0.7) + 30 * lamp(1.2, 0.9, 0.25) * Rgbd(0.6, 0.8, 1);
  return radiance;
}

// Parallel light from a cone of 6° about a slanted direction, on one side of a plane only: the edge of a beam at x = 0.5.
inline Vec3d beam_direction() {
  return Vec3d(0, 0.8, 0.6);
}
inline Rgbd beam_edge(const Vec3d& at, const Vec3d& toward) {
  const bool lit =
      toward.dot(beam_direction()) > std::cos(6 * kPi / 180) && at.x() - toward.x() * (at.y() - 0.5) < 0.5;
  return Rgbd::Constant(lit ? 100 : 0);
}

// Equal steps of the sphere; the exact harmonics of a field at a point but for their number.
inline Eigen::MatrixXd exact_harmonics(const AnalyticField& field, const Vec3d& at, int degree,
                                       int directions) {
  const SpherePartition sphere(directions);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(harmonic_count(degree), 3);
  Eigen::VectorXd y(harmonic_count(degree));
  for (int i = 0; i < directions; ++i) {
    const Vec3d d = sphere.centre(i);
    harmonics(d, degree, y.data());
    sum += sphere.cell_solid_angle_sr() * y * field(at, d).matrix().transpose();
  }
  return sum;
}

inline std::vector<Vec3d> random_positions(std::size_t count, unsigned seed, double margin = 0) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> along(-margin, 1 + margin);
  std::vector<Vec3d> positions(count);
  for (Vec3d& p : positions) p = {along(random), along(random), along(random)};
  return positions;
}

// What probes at these positions see in one direction.
inline std::vector<Rgb> seen(const AnalyticField& field, std::span<const Vec3d> positions,
                             const MeasuredDirection& direction) {
  std::vector<Rgb> radiance;
  for (const Vec3d& p : positions)
    radiance.push_back(field(p + direction.origin, direction.direction).cast<float>());
  return radiance;
}

struct BuiltField {
  LightField field;
  int support = 0;
  double held_out_error = 0;
};
// The whole way in memory, from radiance in each direction to a field.
inline BuiltField build_field(const AnalyticField& truth, const FieldGrid& grid,
                              std::span<const Vec3d> positions, const DirectionBins& bins, int degree,
                              FieldMethod method) {
  SupportChoice choice;
  if (method == FieldMethod::best) {
    DirectionEstimator estimator(grid, positions, method, 0);
    for (std::size_t d = 0; d < bins.directions().size(); d += 1 + bins.directions().size() / 64)
      estimator.hold_out(bins.directions()[d], seen(truth, positions, bins.directions()[d]), choice);
  }
  DirectionEstimator estimator(grid, positions, method, choice.best());
  FieldSums sums(grid, degree);
  std::vector<FieldDirection> batch;
  for (std::size_t d = 0; d < bins.directions().size(); ++d) {
    const MeasuredDirection& direction = bins.directions()[d];
    batch.push_back({ShearPlane(grid, direction.direction, 1), {}, {}, 0});
    estimator.estimate(direction, seen(truth, positions, direction), batch.back());
    batch.back().harmonics =
        bins.harmonics().col(static_cast<Eigen::Index>(d)).head(harmonic_count(degree)).cast<float>();
    batch.back().known_share = static_cast<float>(direction.solid_angle_sr / (4 * kPi));
    if (batch.size() < 32 && d + 1 < bins.directions().size()) continue;
    for (int z = 0; z < sums.slabs(); ++z) sums.add(batch, z);
    batch.clear();
  }
  return {std::move(sums).take(), choice.best(), choice.held_out_error()};
}

// Relative RMS error of the harmonics at points of the cube.
inline double harmonics_error(const LightField& field, const AnalyticField& truth, int points,
                              int directions = 20000) {
  double error = 0, norm = 0;
  for (const Vec3d& p : random_positions(static_cast<std::size_t>(points), 99)) {
    const Eigen::MatrixXd exact = exact_harmonics(truth, p, field.degree, directions);
    error += (light_at(field, p).radiance.matrix() - exact).squaredNorm();
    norm += exact.squaredNorm();
  }
  return std::sqrt(error / norm);
}

}  // namespace lightwell::test
