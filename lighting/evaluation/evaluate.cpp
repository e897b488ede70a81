// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/evaluation/evaluate.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace lightwell {
namespace {

constexpr int kNormals = 642;
constexpr int kGroundSide = 64;
constexpr double kGroundSpacing = 6.0 / kGroundSide;

// Running sums over one ring's sectors of illuminance, and of illuminance times the azimuth's sine and
// cosine.
class RingSums {
 public:
  struct Sum {
    Rgbd flux = Rgbd::Zero();
    Rgbd flux_sin = Rgbd::Zero();
    Rgbd flux_cos = Rgbd::Zero();
    Sum operator-(const Sum& o) const {
      return {flux - o.flux, flux_sin - o.flux_sin, flux_cos - o.flux_cos};
    }
    Sum operator+(const Sum& o) const {
      return {flux + o.flux, flux_sin + o.flux_sin, flux_cos + o.flux_cos};
    }
  };

  // azimuths: sine and cosine of every sector's centre
  RingSums(const PolarMap& map, int ring, const std::vector<Vec2d>& azimuths) : sectors_(map.grid.sectors) {
    const double theta = map.grid.theta_max_rad * (ring + 0.5) / map.grid.rings;
    sin_theta = std::sin(theta);
    cos_theta = std::cos(theta);
    sums_.reserve(azimuths.size() + 1);
    sums_.emplace_back();
    std::size_t bin = static_cast<std::size_t>(ring) * azimuths.size();
    for (const Vec2d& azimuth : azimuths) {
      const Rgbd flux = map.rgb(bin).cast<double>() * static_cast<double>(map.solid_angle_sr[bin]);
      sums_.push_back(sums_.back() + Sum{flux, flux * azimuth[0], flux * azimuth[1]});
      ++bin;
    }
  }

  // Over the sectors whose centre λ has cos(λ − lambda_rad) > cosine.
  [[nodiscard]] Sum around(double lambda_rad, double cosine) const {
    if (cosine >= 1) return {};
    if (cosine < -1) return sums_.back();
    const double middle = lambda_rad / (2 * kPi) * sectors_ - 0.5;
    const double half = std::acos(cosine) / (2 * kPi) * sectors_;
    const auto first = static_cast<std::int64_t>(std::ceil(middle - half));
    const auto last = static_cast<std::int64_t>(std::floor(middle + half));
    if (last < first) return {};
    if (last - first + 1 >= sectors_) return sums_.back();
    const auto a = static_cast<std::size_t>((first % sectors_ + sectors_) % sectors_);
    const auto b = a + static_cast<std::size_t>(last - first + 1);  // may lie beyond the seam
    const auto count = static_cast<std::size_t>(sectors_);
    return b <= count ? sums_[b] - sums_[a] : sums_[count] - sums_[a] + sums_[b - count];
  }
  [[nodiscard]] const Sum& all() const { return sums_.back(); }

  double sin_theta = 0;
  double cos_theta = 0;

 private:
  int sectors_;
  std::vector<Sum> sums_;
};

std::vector<RingSums> ring_sums(const PolarMap& map) {
  std::vector<Vec2d> azimuths;
  for (int sector = 0; sector < map.grid.sectors; ++sector) {
    const double lambda = 2 * kPi * (sector + 0.5) / map.grid.sectors;
    azimuths.emplace_back(std::sin(lambda), std::cos(lambda));
  }
  std::vector<RingSums> rings;
  for (int ring = 0; ring < map.grid.rings; ++ring) rings.emplace_back(map, ring, azimuths);
  return rings;
}

// cos(angle between bin and direction) = sin θ · horizontal · cos(λ − lambda) + cos θ · direction.y
struct Azimuthal {
  double horizontal;
  double lambda_rad;
};
Azimuthal azimuthal(const Vec3d& v) {
  return {std::hypot(v.x(), v.z()), spherical_from_direction(v).lambda_rad};
}

// Where along a ring sin θ · horizontal · c + offset > threshold: the smallest such c (beyond ±1: all, or
// nothing).
double smallest_cosine(double amplitude, double needed) {
  if (amplitude > 0) return needed / amplitude;
  return needed < 0 ? -2 : 2;
}

Rgbd irradiance_of_map(const std::vector<RingSums>& rings, const Vec3d& normal) {
  const auto [horizontal, lambda] = azimuthal(normal);
  Rgbd sum = Rgbd::Zero();
  for (const RingSums& ring : rings) {
    const double offset = ring.cos_theta * normal.y();
    const auto lit = ring.around(lambda, smallest_cosine(ring.sin_theta * horizontal, -offset));
    sum += lit.flux * offset + (lit.flux_cos * std::cos(lambda) + lit.flux_sin * std::sin(lambda)) *
                                   (ring.sin_theta * horizontal);
  }
  return sum;
}

// The sphere hides direction d from ground point p where d · (centre − p) > |p|: the distance to the tangent
// points.
Rgbd shadow_of_map(const std::vector<RingSums>& rings, const Vec3d& point) {
  const auto [horizontal, lambda] = azimuthal(-point);
  Rgbd sum = Rgbd::Zero();
  for (const RingSums& ring : rings) {
    if (ring.cos_theta <= 0) continue;
    const auto hidden =
        ring.around(lambda, smallest_cosine(ring.sin_theta * horizontal, horizontal - ring.cos_theta));
    sum += (ring.all().flux - hidden.flux) * ring.cos_theta;
  }
  return sum;
}

// A set's lights in double, once.
struct Light {
  Vec3d direction;
  Rgbd illuminance;
};
std::vector<Light> in_double(const LightSet& set) {
  std::vector<Light> lights;
  for (const DirectionalLight& light : set.lights)
    lights.push_back({light.direction.cast<double>(), light.illuminance.cast<double>()});
  return lights;
}

double relative_rmse(const std::vector<Rgbd>& values, const std::vector<Rgbd>& reference) {
  double largest = 0;
  for (const Rgbd& r : reference) largest = std::max(largest, r.maxCoeff());
  const double scale = largest > 0 ? 1 / largest : 1;  // squares of 1e-200 would vanish
  double difference = 0;
  double norm = 0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    difference += ((values[i] - reference[i]) * scale).square().sum();
    norm += (reference[i] * scale).square().sum();
  }
  if (difference == 0) return 0;
  return norm > 0 ? std::sqrt(difference / norm) : std::numeric_limits<double>::infinity();
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

std::vector<Rgbd> irradiance_of_lights(const LightSet& set) {
  const std::vector<Light> lights = in_double(set);
  std::vector<Rgbd> values;
  for (const Vec3d& normal : evaluation_normals()) {
    Rgbd sum = set.ambient.cast<double>() * kPi;
    for (const Light& light : lights) {
      const double cosine = normal.dot(light.direction);
      if (cosine > 0) sum += light.illuminance * cosine;
    }
    values.push_back(sum);
  }
  return values;
}

std::vector<Rgbd> shadow_of_lights(const LightSet& set) {
  std::vector<Light> lights = in_double(set);
  std::erase_if(lights, [](const Light& light) { return light.direction.y() <= 0; });
  std::vector<Rgbd> values;
  for (const Vec3d& point : evaluation_ground()) {
    // Of a uniform sky the sphere, which touches the plane but nowhere crosses it, hides π (1/D)² · (1/D):
    // its form factor for a horizontal element at distance D from its centre.
    const double tangent = point.norm();
    const double distance = std::hypot(tangent, 1.0);
    Rgbd sum = set.ambient.cast<double>() * (kPi * (1 - 1 / (distance * distance * distance)));
    const Vec3d to_centre = Vec3d::UnitY() - point;
    for (const Light& light : lights)
      if (light.direction.dot(to_centre) <= tangent) sum += light.illuminance * light.direction.y();
    values.push_back(sum);
  }
  return values;
}

LightEvaluator::LightEvaluator(const PolarMap& map) {
  const std::vector<RingSums> rings = ring_sums(map);
  for (const Vec3d& normal : evaluation_normals())
    map_irradiance_.push_back(irradiance_of_map(rings, normal));
  for (const Vec3d& point : evaluation_ground()) map_shadow_.push_back(shadow_of_map(rings, point));
}

LightError LightEvaluator::error(const LightSet& set) const {
  return {relative_rmse(irradiance_of_lights(set), map_irradiance_),
          relative_rmse(shadow_of_lights(set), map_shadow_)};
}

}  // namespace lightwell
