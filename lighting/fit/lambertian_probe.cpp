// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/fit/lambertian_probe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lightwell {
namespace {

constexpr int kHalf = kProbeNormals / 2;

// Of two opposite normals, the one that goes first: never below the horizon.
bool goes_first(const Vec3d& n) {
  constexpr double kZero = 1e-9;
  if (std::abs(n.y()) > kZero) return n.y() > 0;
  if (std::abs(n.z()) > kZero) return n.z() > 0;
  return n.x() > 0;
}

using Triangle = std::array<Vec3d, 3>;

std::vector<Triangle> icosahedron() {
  const double g = (1 + std::sqrt(5.0)) / 2;
  std::vector<Vec3d> corners;
  for (const double a : {-1.0, 1.0})
    for (const double b : {-g, g}) {
      corners.emplace_back(0, a, b);
      corners.emplace_back(a, b, 0);
      corners.emplace_back(b, 0, a);
    }
  // A face is three corners at the edge's length, 2, from one another.
  std::vector<Triangle> faces;
  const auto is_edge = [](const Vec3d& p, const Vec3d& q) { return std::abs((p - q).norm() - 2) < 1e-9; };
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t j = i + 1; j < corners.size(); ++j)
      for (std::size_t k = j + 1; k < corners.size(); ++k)
        if (is_edge(corners[i], corners[j]) && is_edge(corners[j], corners[k]) &&
            is_edge(corners[i], corners[k]))
          faces.push_back({corners[i].normalized(), corners[j].normalized(), corners[k].normalized()});
  return faces;
}

std::vector<Triangle> divided(const std::vector<Triangle>& faces) {
  std::vector<Triangle> parts;
  for (const auto& [a, b, c] : faces) {
    const Vec3d ab = (a + b).normalized();
    const Vec3d bc = (b + c).normalized();
    const Vec3d ca = (c + a).normalized();
    parts.insert(parts.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return parts;
}

double light_of(float radiance, float solid_angle_sr) {
  const bool is_light = radiance > 0 && radiance <= std::numeric_limits<float>::max();
  return static_cast<double>(is_light ? radiance : 0.0f) * static_cast<double>(solid_angle_sr);
}

}  // namespace

ProbeNormals probe_normals() {
  ProbeNormals normals;
  int count = 0;
  for (const auto& [a, b, c] : divided(divided(icosahedron()))) {
    const Vec3d normal = (a + b + c).normalized();
    if (!goes_first(normal)) continue;
    normals.col(count) = normal;
    normals.col(count + kHalf) = -normal;
    ++count;
  }
  return normals;
}

LambertianProbe::LambertianProbe(const PolarGrid& grid) : grid_(grid), normals_(probe_normals()) {
  for (int sector = 0; sector < grid.sectors; ++sector) {
    const double lambda = 2 * kPi * (sector + 0.5) / grid.sectors;
    sin_lambda_.push_back(std::sin(lambda));
    cos_lambda_.push_back(std::cos(lambda));
  }
  whole_rings_.assign(kHalf, 0);
  for (int ring = 0; ring < grid.rings; ++ring) {
    const double theta = grid.theta_max_rad * (ring + 0.5) / grid.rings;
    sin_theta_.push_back(std::sin(theta));
    cos_theta_.push_back(std::cos(theta));
    ring_intervals_.push_back(intervals_.size());
    for (int face = 0; face < kHalf; ++face) {
      // Seen where n·d = n.y cos θ + h sin θ cos(λ − λ_n) > 0.
      const Vec3d n = normals_.col(face);
      const double amplitude = std::hypot(n.x(), n.z()) * sin_theta_.back();
      const double offset = n.y() * cos_theta_.back();
      if (offset >= amplitude) {  // the rings around the zenith
        whole_rings_[static_cast<std::size_t>(face)] = ring + 1;
        continue;
      }
      if (offset <= -amplitude) continue;
      const double middle = spherical_from_direction(n).lambda_rad / (2 * kPi) * grid.sectors - 0.5;
      const double half = std::acos(-offset / amplitude) / (2 * kPi) * grid.sectors;
      const auto first = static_cast<int>(std::ceil(middle - half));
      const int count = std::min(static_cast<int>(std::floor(middle + half)) - first + 1, grid.sectors);
      if (count <= 0) continue;
      const int begin = ((first % grid.sectors) + grid.sectors) % grid.sectors;
      const bool across = begin + count > grid.sectors;
      intervals_.push_back({static_cast<std::int16_t>(face), static_cast<std::int16_t>(across ? 1 : 0), begin,
                            begin + count - (across ? grid.sectors : 0)});
    }
  }
  ring_intervals_.push_back(intervals_.size());
  lights_.resize(static_cast<std::size_t>(grid.sectors) * 4);
  running_.resize((static_cast<std::size_t>(grid.sectors) + 1) * 12);
  rings_before_.resize((static_cast<std::size_t>(grid.rings) + 1) * 12);
}

// Lanes: 1 for a monochrome map, 4 for colour, of which the last is idle: two pairs of doubles side by side.
template <int kLanes>
void LambertianProbe::sum(const PolarMap& map, ProbeIrradiance& out) noexcept {
  using Lanes = Eigen::Array<double, kLanes, 1>;
  const auto at = [](std::vector<double>& table, std::size_t i) {
    return Eigen::Map<Lanes>(table.data() + i * kLanes);
  };
  std::array<Lanes, kHalf> seen;
  seen.fill(Lanes::Zero());
  Lanes flux_of_all = Lanes::Zero();
  for (std::size_t k = 0; k < 3; ++k) at(rings_before_, k) = Lanes::Zero();
  const auto sectors = static_cast<std::size_t>(grid_.sectors);
  for (std::size_t ring = 0; ring < sin_theta_.size(); ++ring) {
    const float* solid_angle = map.solid_angle_sr.data() + ring * sectors;
    for (std::size_t c = 0; c < std::min<std::size_t>(kLanes, 3); ++c) {
      const float* radiance = map.radiance.data() + c * grid_.size() + ring * sectors;
      for (std::size_t sector = 0; sector < sectors; ++sector)
        lights_[sector * kLanes + c] = light_of(radiance[sector], solid_angle[sector]);
    }
    Lanes flux = Lanes::Zero(), flux_sin = Lanes::Zero(), flux_cos = Lanes::Zero();
    for (std::size_t k = 0; k < 3; ++k) at(running_, k) = Lanes::Zero();
    for (std::size_t sector = 0; sector < sectors; ++sector) {
      const Lanes light = at(lights_, sector);
      flux += light;
      flux_sin += light * sin_lambda_[sector];
      flux_cos += light * cos_lambda_[sector];
      at(running_, 3 * sector + 3) = flux;
      at(running_, 3 * sector + 4) = flux_sin;
      at(running_, 3 * sector + 5) = flux_cos;
    }
    flux_of_all += flux;
    at(rings_before_, 3 * ring + 3) = at(rings_before_, 3 * ring) + flux_sin * sin_theta_[ring];
    at(rings_before_, 3 * ring + 4) = at(rings_before_, 3 * ring + 1) + flux * cos_theta_[ring];
    at(rings_before_, 3 * ring + 5) = at(rings_before_, 3 * ring + 2) + flux_cos * sin_theta_[ring];
    for (std::size_t i = ring_intervals_[ring]; i < ring_intervals_[ring + 1]; ++i) {
      const Interval& interval = intervals_[i];
      const auto first = 3 * static_cast<std::size_t>(interval.first);
      const auto last = 3 * static_cast<std::size_t>(interval.last);
      const auto n = normals_.col(interval.face);
      const double across = interval.across_seam;
      seen[static_cast<std::size_t>(interval.face)] +=
          (at(running_, last) - at(running_, first) + flux * across) * (n.y() * cos_theta_[ring]) +
          (at(running_, last + 1) - at(running_, first + 1) + flux_sin * across) *
              (n.x() * sin_theta_[ring]) +
          (at(running_, last + 2) - at(running_, first + 2) + flux_cos * across) * (n.z() * sin_theta_[ring]);
    }
  }
  const auto along = [&](std::size_t rings, const Vec3d& n) -> Lanes {
    return at(rings_before_, 3 * rings) * n.x() + at(rings_before_, 3 * rings + 1) * n.y() +
           at(rings_before_, 3 * rings + 2) * n.z();
  };
  for (int face = 0; face < kHalf; ++face) {
    const auto i = static_cast<std::size_t>(face);
    const Vec3d n = normals_.col(face);
    const Lanes lit = seen[i] + along(static_cast<std::size_t>(whole_rings_[i]), n);
    const Lanes opposite = lit - along(sin_theta_.size(), n);
    for (int c = 0; c < 3; ++c) {
      const int lane = kLanes == 1 ? 0 : c;
      out(face, c) = std::max(0.0, lit[lane]);
      out(face + kHalf, c) = std::max(0.0, opposite[lane]);  // rounding of a difference
    }
  }
  for (int c = 0; c < 3; ++c) total_[c] = flux_of_all[kLanes == 1 ? 0 : c];
}

void LambertianProbe::irradiance(const PolarMap& map, ProbeIrradiance& out) noexcept {
  if (map.channels == 1)
    sum<1>(map, out);
  else
    sum<4>(map, out);
}

}  // namespace lightwell
