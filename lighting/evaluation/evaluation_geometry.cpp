// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/evaluation/evaluation_geometry.h"

#include <algorithm>
#include <cmath>

#include "lighting/result.h"

namespace lightwell {
namespace {

constexpr int kNormals = 642;
constexpr int kGroundSide = 64;
constexpr double kGroundSpacing = 6.0 / kGroundSide;

// sums[i]: over the first i sectors of a ring.
template <class Sum>
Sum over_run(const std::vector<Sum>& sums, std::int32_t first, std::int32_t count) {
  const auto all = static_cast<std::int32_t>(sums.size()) - 1;
  const auto at = [&](std::int32_t i) -> const Sum& { return sums[static_cast<std::size_t>(i)]; };
  const std::int32_t end = first + count;
  if (end <= all) return at(end) - at(first);
  return (at(all) - at(first)) + at(end - all);
}

// Flux of a ring's bins, and flux times the azimuth's sine and cosine.
struct Moments {
  Rgbd flux = Rgbd::Zero();
  Rgbd flux_sin = Rgbd::Zero();
  Rgbd flux_cos = Rgbd::Zero();
  Moments operator-(const Moments& o) const {
    return {flux - o.flux, flux_sin - o.flux_sin, flux_cos - o.flux_cos};
  }
  Moments operator+(const Moments& o) const {
    return {flux + o.flux, flux_sin + o.flux_sin, flux_cos + o.flux_cos};
  }
};

// cos(angle between bin and normal) = sin θ · horizontal · cos(λ − lambda) + cos θ · normal.y
double horizontal_length(const Vec3d& v) {
  return std::hypot(v.x(), v.z());
}

}  // namespace

std::vector<Vec3d> evaluation_normals() {
  const double golden_angle = kPi * (3 - std::sqrt(5.0));
  std::vector<Vec3d> normals;
  for (int i = 0; i < kNormals; ++i) {
    const double y = 1 - (2 * i + 1.0) / kNormals;
    const double horizontal = std::sqrt(1 - y * y);
    normals.emplace_back(horizontal * std::sin(golden_angle * i), y, horizontal * std::cos(golden_angle * i));
  }
  return normals;
}

std::vector<Vec3d> evaluation_ground() {
  std::vector<Vec3d> points;
  const auto coordinate = [](int i) { return (i + 0.5 - kGroundSide / 2.0) * kGroundSpacing; };
  for (int row = 0; row < kGroundSide; ++row)
    for (int column = 0; column < kGroundSide; ++column)
      points.emplace_back(coordinate(column), 0, coordinate(row));
  return points;
}

EvaluationGeometry::EvaluationGeometry(const PolarGrid& grid, Occluder occluder)
    : grid_(grid), occluder_(occluder), normals_(evaluation_normals()) {
  for (int sector = 0; sector < grid.sectors; ++sector) {
    const double lambda = 2 * kPi * (sector + 0.5) / grid.sectors;
    azimuths_.emplace_back(std::sin(lambda), std::cos(lambda));
  }
  const std::vector<Vec3d> ground = evaluation_ground();
  for (int ring = 0; ring < grid.rings; ++ring) {
    const double theta = grid.theta_max_rad * (ring + 0.5) / grid.rings;
    const double sine = sin_theta_.emplace_back(std::sin(theta));
    const double cosine = cos_theta_.emplace_back(std::cos(theta));
    for (const Vec3d& normal : normals_) {
      const double amplitude = sine * horizontal_length(normal);
      const double needed = -cosine * normal.y();
      const double least = amplitude > 0 ? needed / amplitude : (needed < 0 ? -2 : 2);
      lit_.push_back(run_of({spherical_from_direction(normal).lambda_rad, least >= 1   ? 0
                                                                          : least < -1 ? kPi
                                                                                       : std::acos(least)}));
    }
    if (cosine <= 0) continue;  // light from below does not reach the ground
    for (const Vec3d& point : ground) hidden_.push_back(run_of(hidden_arc(occluder, point, sine, cosine)));
  }
}

EvaluationGeometry::Run EvaluationGeometry::run_of(const AzimuthArc& arc) const {
  if (arc.half_rad <= 0) return {};
  if (arc.half_rad >= kPi) return {0, grid_.sectors};
  const double middle = arc.middle_rad / (2 * kPi) * grid_.sectors - 0.5;
  const double half = arc.half_rad / (2 * kPi) * grid_.sectors;
  const auto first = static_cast<std::int64_t>(std::ceil(middle - half));
  const auto last = static_cast<std::int64_t>(std::floor(middle + half));
  if (last < first) return {};
  if (last - first + 1 >= grid_.sectors) return {0, grid_.sectors};
  return {static_cast<std::int32_t>((first % grid_.sectors + grid_.sectors) % grid_.sectors),
          static_cast<std::int32_t>(last - first + 1)};
}

void EvaluationGeometry::irradiance(const PolarMap& map, std::vector<Rgbd>& values) const {
  verify_bug(map.grid == grid_, "the map has another grid than the evaluation");
  values.assign(normals_.size(), Rgbd::Zero());
  std::vector<Moments> sums(azimuths_.size() + 1);
  std::size_t bin = 0;
  auto lit = lit_.begin();
  for (std::size_t ring = 0; ring < sin_theta_.size(); ++ring) {
    for (std::size_t sector = 0; sector < azimuths_.size(); ++sector, ++bin) {
      const Rgbd flux = map.rgb(bin).cast<double>() * static_cast<double>(map.solid_angle_sr[bin]);
      sums[sector + 1] =
          sums[sector] + Moments{flux, flux * azimuths_[sector][0], flux * azimuths_[sector][1]};
    }
    for (std::size_t i = 0; i < normals_.size(); ++i, ++lit) {
      const Moments m = over_run(sums, lit->first, lit->count);
      values[i] += m.flux * (cos_theta_[ring] * normals_[i].y()) +
                   (m.flux_cos * normals_[i].z() + m.flux_sin * normals_[i].x()) * sin_theta_[ring];
    }
  }
}

void EvaluationGeometry::shadow(const PolarMap& map, std::vector<Rgbd>& values) const {
  verify_bug(map.grid == grid_, "the map has another grid than the evaluation");
  constexpr std::size_t kPoints = kGroundSide * kGroundSide;
  values.assign(kPoints, Rgbd::Zero());
  std::vector<Rgbd> sums(azimuths_.size() + 1, Rgbd::Zero());
  std::size_t bin = 0;
  auto hidden = hidden_.begin();
  for (std::size_t ring = 0; ring < cos_theta_.size() && cos_theta_[ring] > 0; ++ring) {
    for (std::size_t sector = 0; sector < azimuths_.size(); ++sector, ++bin)
      sums[sector + 1] =
          sums[sector] + map.rgb(bin).cast<double>() * static_cast<double>(map.solid_angle_sr[bin]);
    for (std::size_t i = 0; i < kPoints; ++i, ++hidden)
      values[i] += (sums.back() - over_run(sums, hidden->first, hidden->count)) * cos_theta_[ring];
  }
}

}  // namespace lightwell
