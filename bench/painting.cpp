// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/painting.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lightwell::bench {
namespace {

constexpr double kDegree = kPi / 180;

// SplitMix64's finaliser: well-mixed bits of a counter.
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

double lattice(std::int64_t x, std::int64_t y, std::uint32_t seed) {
  const std::uint64_t bits = mixed(static_cast<std::uint64_t>(x) * 0x1f123bb5u ^
                                   static_cast<std::uint64_t>(y) * 0x5851f42d4c957f2du ^ seed);
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

// 1 inside, 0 outside, over one degree.
double soft(double inside_deg) {
  return std::clamp(inside_deg + 0.5, 0.0, 1.0);
}

std::size_t bin_of(const PolarGrid& grid, int ring, int sector) {
  const int s = (sector % grid.sectors + grid.sectors) % grid.sectors;
  return static_cast<std::size_t>(ring) * static_cast<std::size_t>(grid.sectors) +
         static_cast<std::size_t>(s);
}

}  // namespace

std::vector<Vec3f> bin_directions(const PolarGrid& grid) {
  std::vector<Vec3f> directions;
  for (int ring = 0; ring < grid.rings; ++ring)
    for (int sector = 0; sector < grid.sectors; ++sector)
      directions.push_back(grid.bin_direction(ring, sector).cast<float>());
  return directions;
}

void paint(PolarMap& map, const std::function<Rgb(const Vec3d&)>& radiance) {
  std::size_t bin = 0;
  for (int ring = 0; ring < map.grid.rings; ++ring)
    for (int sector = 0; sector < map.grid.sectors; ++sector, ++bin) {
      const Rgb value = radiance(map.grid.bin_direction(ring, sector));
      for (int c = 0; c < 3; ++c) map.plane(c)[bin] = value[c];
    }
}

Vec3d from_degrees(double zenith_deg, double azimuth_deg) {
  return direction_from_spherical({zenith_deg * kDegree, azimuth_deg * kDegree});
}

void add_disc(PolarMap& map, const Vec3d& centre, double radius_deg, const Rgb& illuminance) {
  const PolarGrid& grid = map.grid;
  const double ring_deg = grid.theta_max_rad / kDegree / grid.rings;
  const double zenith_deg = spherical_from_direction(centre).theta_rad / kDegree;
  const double reach = radius_deg + 1;
  const int first = std::max(0, static_cast<int>((zenith_deg - reach) / ring_deg));
  const int last = std::min(grid.rings - 1, static_cast<int>((zenith_deg + reach) / ring_deg));
  const double least_cosine = std::cos(reach * kDegree);
  std::vector<std::pair<std::size_t, float>> shares;
  double sum = 0;
  for (int ring = first; ring <= last; ++ring)
    for (int sector = 0; sector < grid.sectors; ++sector) {
      const double cosine = grid.bin_direction(ring, sector).dot(centre);
      if (cosine < least_cosine) continue;
      const double share = soft(radius_deg - std::acos(std::min(1.0, cosine)) / kDegree);
      const std::size_t bin = bin_of(grid, ring, sector);
      if (share <= 0) continue;
      shares.emplace_back(bin, static_cast<float>(share));
      sum += share * static_cast<double>(map.solid_angle_sr[bin]);
    }
  for (const auto& [bin, share] : shares)
    for (int c = 0; c < 3; ++c) map.plane(c)[bin] += share * illuminance[c] / static_cast<float>(sum);
}

void blend_rectangle(PolarMap& map, const Rectangle& where, const Rgb& radiance, double share) {
  const PolarGrid& grid = map.grid;
  const double ring_deg = grid.theta_max_rad / kDegree / grid.rings;
  const double sector_deg = 360.0 / grid.sectors;
  const auto inside = [](double value, double from, double to) {
    return std::min(soft(value - from), soft(to - value));
  };
  for (int ring = 0; ring < grid.rings; ++ring) {
    const double down = inside((ring + 0.5) * ring_deg, where.zenith_from_deg, where.zenith_to_deg);
    if (down <= 0) continue;
    const int first = static_cast<int>(std::floor((where.azimuth_from_deg - 1) / sector_deg));
    const int last = static_cast<int>(std::ceil((where.azimuth_to_deg + 1) / sector_deg));
    for (int sector = first; sector <= last; ++sector) {
      const double along = inside((sector + 0.5) * sector_deg, where.azimuth_from_deg, where.azimuth_to_deg);
      const auto weight = static_cast<float>(share * down * along);
      const std::size_t bin = bin_of(grid, ring, sector);
      for (int c = 0; c < 3; ++c) {
        float& value = map.plane(c)[bin];
        value += weight * (radiance[c] - value);
      }
    }
  }
}

Rgb sky_radiance(const Vec3d& d) {
  const double slant = 1 / std::max(0.15, d.y());
  const double cloud = cloud_noise(1.5 * d.x() * slant, 1.5 * d.z() * slant, 5);
  const double grey = std::clamp(2.5 * (cloud - 0.45), 0.0, 1.0);
  const double value = 1200 * (1 + std::pow(1 - std::abs(d.y()), 3));
  const Rgbd blue = value * Rgbd(0.6, 0.9, 1.6);
  const Rgbd white = Rgbd(3600, 3500, 3300);
  return (blue + grey * (white - blue)).cast<float>();
}

Rgb room_radiance(const Vec3d& d) {
  const Spherical s = spherical_from_direction(d);
  const double zenith = s.theta_rad / kDegree;
  const double azimuth = s.lambda_rad / kDegree;
  const auto window = [&](double from, double to) {
    return std::min({soft(zenith - 45), soft(80 - zenith), soft(azimuth - from), soft(to - azimuth)});
  };
  Rgbd value(14, 12, 10);
  value *= 1 + 0.8 * std::cos(azimuth * kDegree) * std::sin(s.theta_rad);
  if (d.y() < 0) value *= 0.4;
  const double bright = std::max(window(20, 60), window(75, 100));
  value += bright * (Rgbd(900, 1000, 1100) - value);
  struct Lamp {
    double zenith, azimuth, radius;
    Rgbd radiance;
  };
  static const std::array<Lamp, 3> lamps = {
      {{20, 200, 3, {9000, 7000, 3000}}, {55, 260, 2, {6000, 6000, 5500}}, {70, 310, 4, {300, 300, 2500}}}};
  for (const Lamp& lamp : lamps) {
    const double cosine = std::clamp(d.dot(from_degrees(lamp.zenith, lamp.azimuth)), -1.0, 1.0);
    value += soft(lamp.radius - std::acos(cosine) / kDegree) * lamp.radiance;
  }
  return value.cast<float>();
}

double value_noise(double x, double y, std::uint32_t seed) {
  const double fx = std::floor(x);
  const double fy = std::floor(y);
  const auto ix = static_cast<std::int64_t>(fx);
  const auto iy = static_cast<std::int64_t>(fy);
  const auto ease = [](double t) { return t * t * (3 - 2 * t); };
  const double u = ease(x - fx);
  const double v = ease(y - fy);
  const double top = lattice(ix, iy, seed) * (1 - u) + lattice(ix + 1, iy, seed) * u;
  const double bottom = lattice(ix, iy + 1, seed) * (1 - u) + lattice(ix + 1, iy + 1, seed) * u;
  return top * (1 - v) + bottom * v;
}

double cloud_noise(double x, double y, std::uint32_t seed) {
  double sum = 0;
  double weight = 0;
  double share = 1;
  for (std::uint32_t octave = 0; octave < 3; ++octave, share /= 2) {
    const double scale = static_cast<double>(1u << octave);
    sum += share * value_noise(scale * x + 17.3 * octave, scale * y - 9.1 * octave, seed + octave);
    weight += share;
  }
  return sum / weight;
}

void add_relative_noise(PolarMap& map, double sigma, std::uint32_t frame) {
  // Four 16 bit numbers of one 64 bit word: their sum has variance 4/12, and is near enough to a bell.
  const double scale = sigma * std::sqrt(3.0) / 65536;
  std::uint64_t counter = (static_cast<std::uint64_t>(frame) + 1) << 32;
  for (float& value : map.radiance) {
    const std::uint64_t bits = mixed(counter++);
    const auto sum =
        static_cast<double>((bits & 0xffff) + (bits >> 16 & 0xffff) + (bits >> 32 & 0xffff) + (bits >> 48)) -
        131070;
    value *= static_cast<float>(std::max(0.0, 1 + scale * sum));
  }
}

TurnedView::TurnedView(PolarMap sphere, const PolarGrid& grid)
    : sphere_(std::move(sphere)), directions_(bin_directions(grid)) {}

void TurnedView::look(const Vec3d& turn_rad, PolarMap& map) const {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  if (const double angle = turn_rad.norm(); angle > 0) {  // Rodrigues
    const Vec3d k = turn_rad / angle;
    Eigen::Matrix3d cross;
    cross << 0, -k.z(), k.y(), k.z(), 0, -k.x(), -k.y(), k.x(), 0;
    turn += std::sin(angle) * cross + (1 - std::cos(angle)) * cross * cross;
  }
  const Eigen::Matrix3f turned = turn.cast<float>();
  const PolarGrid& g = sphere_.grid;
  const auto rings = static_cast<float>(g.rings / g.theta_max_rad);
  const auto sectors = static_cast<float>(g.sectors / (2 * kPi));
  for (std::size_t bin = 0; bin < directions_.size(); ++bin) {
    const Vec3f d = turned * directions_[bin];
    const float down = std::acos(std::clamp(d.y(), -1.0f, 1.0f)) * rings - 0.5f;
    const float along = std::atan2(d.x(), d.z()) * sectors - 0.5f;
    const auto ring = static_cast<int>(std::floor(down));
    const auto sector = static_cast<int>(std::floor(along));
    const float v = down - static_cast<float>(ring);
    const float u = along - static_cast<float>(sector);
    const int upper = std::clamp(ring, 0, g.rings - 1);
    const int lower = std::clamp(ring + 1, 0, g.rings - 1);
    const std::array<std::size_t, 4> at = {bin_of(g, upper, sector), bin_of(g, upper, sector + 1),
                                           bin_of(g, lower, sector), bin_of(g, lower, sector + 1)};
    for (int c = 0; c < 3; ++c) {
      const auto plane = sphere_.plane(c);
      map.plane(c)[bin] = (1 - v) * ((1 - u) * plane[at[0]] + u * plane[at[1]]) +
                          v * ((1 - u) * plane[at[2]] + u * plane[at[3]]);
    }
  }
}

void turn_about_zenith(const PolarMap& from, double angle_deg, PolarMap& map) {
  const auto sectors = static_cast<std::size_t>(from.grid.sectors);
  const double shift = angle_deg / 360 * from.grid.sectors;
  const double whole = std::floor(shift);
  const auto part = static_cast<float>(shift - whole);
  const auto turned = static_cast<std::int64_t>(whole) % from.grid.sectors;
  const auto start = static_cast<std::size_t>((turned + from.grid.sectors) % from.grid.sectors);
  for (int c = 0; c < from.channels; ++c)
    for (std::size_t row = 0; row < from.grid.size(); row += sectors) {
      const float* source = from.plane(c).data() + row;
      float* out = map.plane(c).data() + row;
      for (std::size_t s = 0; s < sectors; ++s) {
        const std::size_t next = s + 1 < sectors ? s + 1 : 0;
        const std::size_t to = (s + 1 + start) % sectors;
        out[to] = (1 - part) * source[next] + part * source[s];
      }
    }
}

}  // namespace lightwell::bench
