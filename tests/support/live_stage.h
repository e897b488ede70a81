// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "lighting/field/light_field.h"
#include "lighting/map_harmonics.h"
#include "tests/support/analytic_fields.h"

// Light that fisheye probes see of it, and what it is everywhere, for live fields in the unit cube.
namespace lightwell::test {

// A ball that shines evenly: candela toward all sides.
struct LampBall {
  Vec3d position;
  double radius_m = 0.03;
  Rgbd intensity = Rgbd::Constant(100);
};

struct StageLight {
  AnalyticField smooth;  // above the horizon; below it there is nothing
  std::vector<LampBall> lamps;
};

inline Rgbd above_horizon(const StageLight& light, const Vec3d& at, const Vec3d& toward) {
  return toward.y() > 0 ? light.smooth(at, toward) : Rgbd::Zero();
}

// What a probe shows: smooth light at the bins' centres, a lamp's flux spread over the bins that it covers.
inline PolarMap map_at(const StageLight& light, const Vec3d& at, const PolarGrid& grid = {}) {
  PolarMap map = PolarMap::make(grid, 3);
  const auto sectors = static_cast<std::size_t>(grid.sectors);
  for (std::size_t bin = 0; bin < grid.size(); ++bin) {
    const Rgbd value = above_horizon(
        light, at, grid.bin_direction(static_cast<int>(bin / sectors), static_cast<int>(bin % sectors)));
    for (int c = 0; c < 3; ++c) map.plane(c)[bin] = static_cast<float>(value[c]);
  }
  // Places of a bin that the ball covers, of 4 × 4; then the whole is given the ball's flux.
  for (const LampBall& lamp : light.lamps) {
    const Vec3d toward = lamp.position - at;
    const double distance = std::max(toward.norm(), 1e-9);
    const double radius = std::asin(std::min(1.0, lamp.radius_m / distance));
    const double cosine = std::cos(radius), near = std::cos(std::min(kPi, radius + 0.1));
    std::vector<float> covered(grid.size(), 0.0f);
    double solid_angle = 0;
    for (std::size_t bin = 0; bin < grid.size(); ++bin) {
      const int ring = static_cast<int>(bin / sectors), sector = static_cast<int>(bin % sectors);
      if (grid.bin_direction(ring, sector).dot(toward) < near * distance) continue;
      for (int i = 0; i < 16; ++i) {
        const Vec3d d =
            direction_from_spherical({grid.theta_max_rad * (ring + (i / 4 + 0.5) / 4) / grid.rings,
                                      2 * kPi * (sector + (i % 4 + 0.5) / 4) / grid.sectors});
        if (d.dot(toward) >= cosine * distance) covered[bin] += 1.0f / 16;
      }
      solid_angle += static_cast<double>(covered[bin]) * grid.bin_solid_angle_sr(ring);
    }
    // Of the part above the edge, as of an even disc.
    const double whole = 2 * kPi * (1 - cosine);
    const Rgbd radiance = lamp.intensity / std::pow(std::max(distance, lamp.radius_m), 2) /
                          (toward.y() > lamp.radius_m ? std::max(solid_angle, 1e-9) : whole);
    for (std::size_t bin = 0; bin < grid.size(); ++bin)
      for (int c = 0; c < 3; ++c) map.plane(c)[bin] += covered[bin] * static_cast<float>(radiance[c]);
  }
  return map;
}

// Harmonics at a place: of the smooth light above the horizon, and of the lamps wherever they are.
inline Eigen::MatrixXd exact_harmonics(const StageLight& light, const Vec3d& at, int directions = 20000) {
  Eigen::MatrixXd sum =
      exact_harmonics([&](const Vec3d& p, const Vec3d& d) { return above_horizon(light, p, d); }, at,
                      kRadianceDegree, directions);
  Eigen::VectorXd y(sum.rows());
  for (const LampBall& lamp : light.lamps) {
    const Vec3d toward = lamp.position - at;
    harmonics(toward.normalized(), kRadianceDegree, y.data());
    sum += y * (lamp.intensity / toward.squaredNorm()).matrix().transpose();
  }
  return sum;
}

// The baseline: the probes' own harmonics by inverse square distance.
// source: Shepard 1968, "A two-dimensional interpolation function for irregularly-spaced data"
inline Eigen::MatrixXd shepard(std::span<const Vec3d> positions, std::span<const Eigen::MatrixXd> own,
                               const Vec3d& at) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(own.front().rows(), 3);
  double weights = 0;
  for (std::size_t n = 0; n < positions.size(); ++n) {
    const double weight = 1 / ((at - positions[n]).squaredNorm() + 1e-9);
    sum += weight * own[n];
    weights += weight;
  }
  return sum / weights;
}

// Walls that shine unevenly, without lamps.
inline Rgbd walls(const Vec3d& at, const Vec3d& toward) {
  return box_of_lamps(at, toward).min(3.0);
}

}  // namespace lightwell::test
