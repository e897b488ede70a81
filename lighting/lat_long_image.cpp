// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/lat_long_image.h"

#include <algorithm>
#include <cmath>

#include "lighting/result.h"
#include "lighting/spherical_cap.h"

namespace lightwell {
namespace {

int wrapped(std::int64_t index, int count) {
  const std::int64_t r = index % count;
  return static_cast<int>(r < 0 ? r + count : r);
}

// A target bin's share of a source bin along one coordinate.
struct Share {
  int source;
  double fraction;  // of the source bin
};

// shares[target]: the source bins that overlap it. edge_*(i): increasing measure (area) below bin i.
template <class SourceEdge, class TargetEdge>
std::vector<std::vector<Share>> shares_by_area(int sources, SourceEdge source_edge, int targets,
                                               TargetEdge target_edge) {
  std::vector<std::vector<Share>> shares(static_cast<std::size_t>(targets));
  int s = 0;
  for (int t = 0; t < targets; ++t) {
    const double t0 = target_edge(t);
    const double t1 = target_edge(t + 1);
    while (s < sources && source_edge(s + 1) <= t0) ++s;
    for (int k = s; k < sources && source_edge(k) < t1; ++k) {
      const double s0 = source_edge(k);
      const double s1 = source_edge(k + 1);
      const double overlap = std::min(s1, t1) - std::max(s0, t0);
      if (overlap > 0) shares[static_cast<std::size_t>(t)].push_back({k, std::min(1.0, overlap / (s1 - s0))});
    }
  }
  // The shares of one source inside the target grid add up to 1 exactly only without rounding; make it so.
  std::vector<double> sum(static_cast<std::size_t>(sources), 0);
  for (const auto& list : shares)
    for (const Share& share : list) sum[static_cast<std::size_t>(share.source)] += share.fraction;
  for (auto& list : shares)
    for (Share& share : list) {
      const double total = sum[static_cast<std::size_t>(share.source)];
      if (std::abs(total - 1) < 1e-9) share.fraction /= total;
    }
  return shares;
}

// The map's bin whose area holds the direction (theta, lambda), the edge's where it lies beyond.
std::size_t nearest_bin(const PolarGrid& grid, double theta_rad, double lambda_rad) {
  const int ring =
      std::clamp(static_cast<int>(theta_rad / grid.theta_max_rad * grid.rings), 0, grid.rings - 1);
  const int sector = std::clamp(static_cast<int>(lambda_rad / (2 * kPi) * grid.sectors), 0, grid.sectors - 1);
  return static_cast<std::size_t>(ring) * static_cast<std::size_t>(grid.sectors) +
         static_cast<std::size_t>(sector);
}

// The bin that a pixel of an image is of, in a map of a ring a row and a sector a column. Column x spans the azimuths
// below 2π (W/2 − x) / W: the sectors run the other way, from the middle.
std::size_t bin_of_pixel(const LatLongImage& image, int x, int y) {
  const int sector = (image.width / 2 - x - 1 + image.width) % image.width;
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
         static_cast<std::size_t>(sector);
}

}  // namespace

double LatLongImage::pixel_solid_angle_sr(int y) const {
  return PolarGrid{height, width, kPi}.bin_solid_angle_sr(y);
}

PolarMap polar_map_from_lat_long(const LatLongImage& image, bool hemisphere, double rotate_y_rad) {
  const int column_halves = image.width % 2 == 0 ? 1 : 2;
  const int row_halves = hemisphere && image.height % 2 != 0 ? 2 : 1;
  PolarGrid grid;
  grid.sectors = image.width * column_halves;
  grid.rings = hemisphere ? image.height * row_halves / 2 : image.height;
  grid.theta_max_rad = hemisphere ? kPi / 2 : kPi;
  PolarMap map = PolarMap::make(grid, 3);

  // Column x spans azimuths π − 2π(x+1)/width to π − 2πx/width: unrotated sector s shows column (sectors/2 −
  // 1 − s). Rotated by `turn` sectors, sector s shows what was at s − turn: a part of two neighbours where
  // turn is not whole.
  const double full_turns = rotate_y_rad / (2 * kPi);
  double turn = (full_turns - std::floor(full_turns)) * grid.sectors;
  if (std::abs(turn - std::round(turn)) < 1e-9 * grid.sectors)
    turn = std::round(turn);  // degrees are not exact in π
  const auto whole = static_cast<std::int64_t>(std::floor(turn));
  const auto part = static_cast<float>(turn - std::floor(turn));
  const auto column_of = [&](std::int64_t sector) {
    return wrapped(grid.sectors / 2 - 1 - sector, grid.sectors) / column_halves;
  };
  for (int ring = 0; ring < grid.rings; ++ring) {
    const int y = ring / row_halves;
    for (int sector = 0; sector < grid.sectors; ++sector) {
      Rgb value = image.at(column_of(sector - whole), y);
      if (part > 0) value = value * (1 - part) + image.at(column_of(sector - whole - 1), y) * part;
      const std::size_t bin = static_cast<std::size_t>(ring) * static_cast<std::size_t>(grid.sectors) +
                              static_cast<std::size_t>(sector);
      for (int c = 0; c < 3; ++c) map.plane(c)[bin] = value[c];
    }
  }
  map.peak = map.radiance;
  return map;
}

PolarMap resample_polar(const PolarMap& map, const PolarGrid& grid) {
  const PolarGrid& from = map.grid;
  const auto rings = shares_by_area(
      from.rings, [&](int i) { return cap_measure(from.ring_edge_rad(i)); }, grid.rings,
      [&](int i) { return cap_measure(grid.ring_edge_rad(i)); });
  const auto sectors = shares_by_area(
      from.sectors, [&](int i) { return static_cast<double>(i) / from.sectors; }, grid.sectors,
      [&](int i) { return static_cast<double>(i) / grid.sectors; });

  PolarMap out = PolarMap::make(grid, map.channels);
  const auto planes = static_cast<std::size_t>(map.channels);
  double measured_in = 0;
  for (const float omega : map.solid_angle_sr) measured_in += static_cast<double>(omega);
  double measured_out = 0;
  std::size_t bin = 0;
  for (int ring = 0; ring < grid.rings; ++ring)
    for (int sector = 0; sector < grid.sectors; ++sector, ++bin) {
      double omega = 0;
      Rgbd flux = Rgbd::Zero();
      Rgb peak = Rgb::Zero();
      for (const Share& r : rings[static_cast<std::size_t>(ring)])
        for (const Share& s : sectors[static_cast<std::size_t>(sector)]) {
          const std::size_t source =
              static_cast<std::size_t>(r.source) * static_cast<std::size_t>(from.sectors) +
              static_cast<std::size_t>(s.source);
          const double part = r.fraction * s.fraction * static_cast<double>(map.solid_angle_sr[source]);
          omega += part;
          for (std::size_t c = 0; c < planes; ++c) {
            flux[static_cast<Eigen::Index>(c)] +=
                part * static_cast<double>(map.radiance[c * from.size() + source]);
            peak[static_cast<Eigen::Index>(c)] =
                std::max(peak[static_cast<Eigen::Index>(c)], map.peak[c * from.size() + source]);
          }
        }
      out.solid_angle_sr[bin] = static_cast<float>(omega);
      measured_out += omega;
      // The stored solid angle is a float; dividing by it as stored keeps the product, the bin's illuminance.
      const auto stored = static_cast<double>(out.solid_angle_sr[bin]);
      const double theta = grid.theta_max_rad * (ring + 0.5) / grid.rings;
      const std::size_t nearest = nearest_bin(from, theta, 2 * kPi * (sector + 0.5) / grid.sectors);
      for (std::size_t c = 0; c < planes; ++c) {
        const auto k = static_cast<Eigen::Index>(c);
        out.radiance[c * grid.size() + bin] =
            stored > 0 ? static_cast<float>(flux[k] / stored) : map.radiance[c * from.size() + nearest];
        out.peak[c * grid.size() + bin] = stored > 0 ? peak[k] : 0.0f;
      }
    }
  for (std::size_t source = 0; source < from.size(); ++source) {
    if (map.clipped[source] == 0) continue;
    const auto ring = static_cast<int>(source / static_cast<std::size_t>(from.sectors));
    const auto sector = static_cast<int>(source % static_cast<std::size_t>(from.sectors));
    const double theta = from.theta_max_rad * (ring + 0.5) / from.rings;
    if (theta > grid.theta_max_rad) continue;
    auto& count = out.clipped[nearest_bin(grid, theta, 2 * kPi * (sector + 0.5) / from.sectors)];
    count = static_cast<std::uint16_t>(std::min(65535, count + map.clipped[source]));
  }
  out.clipped_pixels = map.clipped_pixels;
  out.coverage = measured_in > 0
                     ? static_cast<float>(static_cast<double>(map.coverage) * measured_out / measured_in)
                     : 0.0f;
  return out;
}

LatLongImage lat_long_from_polar_map(const PolarMap& map) {
  LatLongImage image;
  image.height = std::max(2, static_cast<int>(std::lround(map.grid.rings * kPi / map.grid.theta_max_rad)));
  image.width = map.grid.sectors + map.grid.sectors % 2;
  const PolarMap whole = resample_polar(map, {image.height, image.width, kPi});
  image.pixels.resize(whole.grid.size());
  for (int y = 0; y < image.height; ++y) {
    // Bins beyond the map carry its edge's radiance: nothing was measured there.
    const bool measured = (y + 0.5) * kPi / image.height < map.grid.theta_max_rad;
    for (int x = 0; x < image.width; ++x)
      image.at(x, y) = measured ? whole.rgb(bin_of_pixel(image, x, y)) : Rgb(Rgb::Zero());
  }
  return image;
}

LatLongImage lat_long_of_measured(const PolarMap& map) {
  LatLongImage image;
  image.height = map.grid.rings;
  image.width = map.grid.sectors;
  verify_bug(image.width % 2 == 0 && map.grid.theta_max_rad == kPi, "a map that is not of the whole sphere");
  image.pixels.resize(map.grid.size());
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const std::size_t bin = bin_of_pixel(image, x, y);
      const double seen = static_cast<double>(map.solid_angle_sr[bin]) / map.grid.bin_solid_angle_sr(y);
      image.at(x, y) = map.rgb(bin) * static_cast<float>(seen);
    }
  return image;
}

}  // namespace lightwell
