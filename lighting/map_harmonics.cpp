// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/map_harmonics.h"

#include <cmath>
#include <limits>

namespace lightwell {
namespace {

double light_of(float radiance, float solid_angle_sr) {
  const bool is_light = radiance > 0 && radiance <= std::numeric_limits<float>::max();
  return static_cast<double>(is_light ? radiance : 0.0f) * static_cast<double>(solid_angle_sr);
}

}  // namespace

Rgbd irradiance(const RadianceHarmonics& radiance, const Vec3d& normal) noexcept {
  std::array<double, harmonic_count(kRadianceDegree)> values;
  harmonics(normal, kRadianceDegree, values.data());
  Rgbd sum = Rgbd::Zero();
  for (int l = 0; l <= kRadianceDegree; ++l)
    for (int m = -l; m <= l; ++m) {
      const int i = harmonic_index(l, m);
      sum += radiance.row(i).transpose() * (irradiance_factor(l) * values[static_cast<std::size_t>(i)]);
    }
  return sum;
}

MapHarmonics::MapHarmonics(const PolarGrid& grid) : grid_(grid) {
  const Eigen::Index half = (grid.sectors + 1) / 2;
  cosines_.resize(half, kOrders);
  sines_.resize(half, kOrders);
  for (Eigen::Index s = 0; s < half; ++s)
    for (Eigen::Index m = 0; m < kOrders; ++m) {
      const double angle = static_cast<double>(m) * 2 * kPi * (static_cast<double>(s) + 0.5) / grid.sectors;
      cosines_(s, m) = std::cos(angle);
      sines_(s, m) = std::sin(angle);
    }
  zonal_.resize(grid.rings, harmonic_count(kRadianceDegree));
  std::array<double, harmonic_count(kRadianceDegree)> at_zero;
  for (int ring = 0; ring < grid.rings; ++ring) {
    const double theta = grid.theta_max_rad * (ring + 0.5) / grid.rings;
    harmonics(direction_from_spherical({theta, 0}), kRadianceDegree, at_zero.data());
    for (int l = 0; l <= kRadianceDegree; ++l)
      for (int m = -l; m <= l; ++m)
        zonal_(ring, harmonic_index(l, m)) =
            at_zero[static_cast<std::size_t>(harmonic_index(l, std::abs(m)))];
  }
  even_.resize(half);
  odd_.resize(half);
}

// Sector sectors − 1 − s has the azimuth −λ of sector s: cosines meet the sum of both, sines the difference.
const RadianceHarmonics& MapHarmonics::project(const PolarMap& map) noexcept {
  result_.setZero();
  const auto sectors = static_cast<std::size_t>(grid_.sectors);
  const std::size_t pairs = sectors / 2;
  for (int ring = 0; ring < grid_.rings; ++ring) {
    const std::size_t begin = static_cast<std::size_t>(ring) * sectors;
    const float* solid_angle = map.solid_angle_sr.data() + begin;
    for (int c = 0; c < map.channels; ++c) {
      const float* radiance = map.plane(c).data() + begin;
      double* even = even_.data();
      double* odd = odd_.data();
      for (std::size_t s = 0; s < pairs; ++s) {
        const double here = light_of(radiance[s], solid_angle[s]);
        const double there = light_of(radiance[sectors - 1 - s], solid_angle[sectors - 1 - s]);
        even[s] = here + there;
        odd[s] = here - there;
      }
      if (sectors % 2 != 0) {  // the middle one, at π, is its own counterpart
        even[pairs] = light_of(radiance[pairs], solid_angle[pairs]);
        odd[pairs] = 0;
      }
      for (int m = 0; m < kOrders; ++m) {
        const double with_cosine = cosines_.col(m).dot(even_);
        const double with_sine = m > 0 ? sines_.col(m).dot(odd_) : 0;
        for (int l = m; l <= kRadianceDegree; ++l) {
          result_(harmonic_index(l, m), c) += zonal_(ring, harmonic_index(l, m)) * with_cosine;
          if (m > 0) result_(harmonic_index(l, -m), c) += zonal_(ring, harmonic_index(l, -m)) * with_sine;
        }
      }
    }
  }
  if (map.channels == 1) result_.col(1) = result_.col(2) = result_.col(0);
  return result_;
}

}  // namespace lightwell
