// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/penrose_sampling.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <queue>
#include <variant>

#include "lighting/decomposition/cell_powers.h"
#include "lighting/decomposition/lit_bins.h"
#include "lighting/decomposition/map_maximum.h"
#include "lighting/decomposition/robinson_tiling.h"
#include "lighting/decomposition/uniform_lights.h"
#include "lighting/result.h"
#include "lighting/spherical_cap.h"

namespace lightwell {
namespace {

// Mean luminance over each bin's own solid angle, in proportion to power an area of the disc.
std::vector<double> power_densities(const PolarMap& map) {
  std::vector<double> density(map.grid.size());
  std::size_t bin = 0;
  for (int ring = 0; ring < map.grid.rings; ++ring)
    for (int sector = 0; sector < map.grid.sectors; ++sector, ++bin)
      density[bin] = luminance(bin_illuminance(map, bin)) / map.grid.bin_solid_angle_sr(ring);
  return density;
}

// The map laid on the unit disc: squared radius is the share of the cap's area inside, angle is azimuth.
class DiscMap {
 public:
  explicit DiscMap(const PolarMap& map)
      : grid_(map.grid),
        cap_(cap_measure(map.grid.theta_max_rad)),
        density_(map.grid, power_densities(map)) {}

  struct Place {
    int ring, sector;
    Vec3d direction;
  };
  // Nothing outside of the disc.
  [[nodiscard]] std::optional<Place> place(const Vec2d& point) const {
    const double radius2 = point.squaredNorm();
    if (radius2 > 1) return std::nullopt;
    const Spherical s = {zenith_angle(std::sqrt(radius2)), azimuth(point)};
    return Place{ring_of(s.theta_rad), sector_of(s.lambda_rad), direction_from_spherical(s)};
  }
  [[nodiscard]] double density(const Place& place) const { return density_.value(place.ring, place.sector); }

  // No density inside of the circle is larger.
  [[nodiscard]] double largest_density(const Vec2d& centre, double radius) const {
    const double distance = centre.norm();
    if (distance - radius > 1) return 0;
    const int inner = ring_of(zenith_angle(std::max(0.0, distance - radius)));
    const int outer = ring_of(zenith_angle(std::min(1.0, distance + radius)));
    if (radius >= distance) return density_.bound(inner, outer, 0, grid_.sectors);
    const double half_width = std::asin(radius / distance) / (2 * kPi) * grid_.sectors;
    const double middle = azimuth(centre) / (2 * kPi) * grid_.sectors;
    const int first = static_cast<int>(std::floor(middle - half_width - kRounding));
    const int last = static_cast<int>(std::floor(middle + half_width + kRounding));
    return density_.bound(inner, outer, (first + grid_.sectors) % grid_.sectors, last - first + 1);
  }

 private:
  static constexpr double kRounding = 1e-9;  // sectors

  [[nodiscard]] double zenith_angle(double radius) const {
    return 2 * std::asin(std::min(1.0, radius * std::sqrt(cap_ / 2)));
  }
  static double azimuth(const Vec2d& point) {
    const double lambda = std::atan2(point.x(), point.y());
    return lambda < 0 ? lambda + 2 * kPi : lambda;
  }
  [[nodiscard]] int ring_of(double theta_rad) const {
    return std::clamp(static_cast<int>(theta_rad / grid_.theta_max_rad * grid_.rings), 0, grid_.rings - 1);
  }
  [[nodiscard]] int sector_of(double lambda_rad) const {
    return std::clamp(static_cast<int>(lambda_rad / (2 * kPi) * grid_.sectors), 0, grid_.sectors - 1);
  }

  PolarGrid grid_;
  double cap_;
  MapMaximum density_;
};

// Vertices by rank / density, and the tiles they may still come out of, by a lower bound of that.
class BestFirst {
 public:
  BestFirst(const DiscMap& disc, const RobinsonTriangle& root) : disc_(disc) { add(root); }

  // Nothing when no lit place is left that the hierarchy reaches.
  std::optional<DiscMap::Place> next() {
    while (!queue_.empty()) {
      const Entry entry = queue_.top();
      queue_.pop();
      if (const auto* place = std::get_if<DiscMap::Place>(&entry.what)) return *place;
      divide(std::get<RobinsonTriangle>(entry.what));
    }
    return std::nullopt;
  }

 private:
  struct Entry {
    double key;
    std::uint64_t order;  // of coming in: decides between equal keys
    std::variant<RobinsonTriangle, DiscMap::Place> what;
    bool operator<(const Entry& other) const {  // the queue has the largest on top
      return key != other.key ? key > other.key : order > other.order;
    }
  };

  void add(const RobinsonTriangle& triangle) {
    const Vec2d centre = (triangle.apex + triangle.b + triangle.c) / 3;
    const double radius =
        std::sqrt(std::max({(triangle.apex - centre).squaredNorm(), (triangle.b - centre).squaredNorm(),
                            (triangle.c - centre).squaredNorm()}));
    const double density = disc_.largest_density(centre, radius);
    if (!(density > 0) || triangle.digits > kMostDigits) return;
    queue_.push({static_cast<double>(triangle.least_rank()) / density, order_++, triangle});
  }

  void divide(const RobinsonTriangle& triangle) {
    const Subdivision parts = subdivide(triangle);
    for (const TilingVertex& vertex : parts.new_vertices()) {
      const auto place = disc_.place(vertex.place);
      if (!place || !(disc_.density(*place) > 0)) continue;
      queue_.push({static_cast<double>(vertex.rank) / disc_.density(*place), order_++, *place});
    }
    for (const RobinsonTriangle& child : parts.children()) add(child);
  }

  const DiscMap& disc_;
  std::priority_queue<Entry> queue_;
  std::uint64_t order_ = 0;
};

double turn_of(std::uint32_t seed) {
  return seed * (2 * kPi * 0x1p-32);
}

}  // namespace

std::vector<DirectionalLight> penrose_sampling(const PolarMap& map, int count, std::uint32_t seed) {
  if (!(luminance(total_illuminance(map)) > 0)) return dark_lights(map.grid, count);
  const DiscMap disc(map);
  BestFirst vertices(disc, triangle_around_unit_disc(turn_of(seed)));
  std::vector<DirectionalLight> lights;
  while (lights.size() < static_cast<std::size_t>(count)) {
    const auto place = vertices.next();
    if (!place) break;
    const std::size_t bin =
        static_cast<std::size_t>(place->ring) * static_cast<std::size_t>(map.grid.sectors) +
        static_cast<std::size_t>(place->sector);
    DirectionalLight light;
    light.direction = place->direction.cast<float>();
    light.illuminance = map.rgb(bin);
    lights.push_back(light);
  }
  verify_bug(!lights.empty(), "a lit map without a vertex of the tiling");
  set_equal_powers(map, lights);
  DirectionalLight dark = lights.front();
  dark.illuminance = Rgb::Zero();
  lights.resize(static_cast<std::size_t>(count), dark);
  return lights;
}

}  // namespace lightwell
