// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/map_regions.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "lighting/decomposition/lit_bins.h"

namespace lightwell {
namespace {

constexpr int kDark = -1;

double standard_deviation(const PolarMap& map) {
  double weight = 0;
  double sum = 0;
  for (std::size_t bin = 0; bin < map.grid.size(); ++bin) {
    weight += static_cast<double>(map.solid_angle_sr[bin]);
    sum += luminance(bin_illuminance(map, bin));
  }
  const double mean = sum / weight;
  double square = 0;
  for (std::size_t bin = 0; bin < map.grid.size(); ++bin) {
    const double off = luminance(map.rgb(bin).cast<double>().eval()) - mean;
    square += static_cast<double>(map.solid_angle_sr[bin]) * off * off;
  }
  return std::sqrt(square / weight);
}

std::vector<int> layer_of_bins(const PolarMap& map, int layers) {
  const double step = standard_deviation(map);
  std::vector<int> layer(map.grid.size(), kDark);
  for (std::size_t bin = 0; bin < layer.size(); ++bin) {
    if (!(luminance(bin_illuminance(map, bin)) > 0)) continue;
    const double height = luminance(map.rgb(bin).cast<double>().eval());
    layer[bin] = step > 0 ? static_cast<int>(std::min(height / step, layers - 1.0)) : 0;
  }
  return layer;
}

class Flood {
 public:
  Flood(const PolarMap& map, std::vector<int> layer)
      : map_(map), layer_(std::move(layer)), seen_(layer_.size(), false) {}

  std::vector<MapRegion> regions() {
    std::vector<MapRegion> all;
    for (std::size_t bin = 0; bin < layer_.size(); ++bin)
      if (layer_[bin] != kDark && !seen_[bin]) all.push_back(fill(bin));
    std::stable_sort(all.begin(), all.end(), [](const MapRegion& a, const MapRegion& b) {
      return a.layer != b.layer ? a.layer > b.layer : a.luminance > b.luminance;
    });
    return all;
  }

 private:
  MapRegion fill(std::size_t start) {
    MapRegion region;
    region.layer = layer_[start];
    enter(start, region);
    for (std::size_t next = 0; next < region.bins.size(); ++next) enter_neighbours(region.bins[next], region);
    std::sort(region.bins.begin(), region.bins.end());
    return region;
  }

  void enter(std::size_t bin, MapRegion& region) {
    if (seen_[bin] || layer_[bin] != region.layer) return;
    seen_[bin] = true;
    region.bins.push_back(static_cast<std::uint32_t>(bin));
    region.luminance += luminance(bin_illuminance(map_, bin));
    region.solid_angle_sr += static_cast<double>(map_.solid_angle_sr[bin]);
  }

  void enter_neighbours(std::size_t bin, MapRegion& region) {
    const auto sectors = static_cast<std::size_t>(map_.grid.sectors);
    const auto rings = static_cast<std::size_t>(map_.grid.rings);
    const std::size_t ring = bin / sectors;
    const std::size_t sector = bin % sectors;
    enter(ring * sectors + (sector + 1) % sectors, region);
    enter(ring * sectors + (sector + sectors - 1) % sectors, region);
    if (ring > 0) enter(bin - sectors, region);
    if (ring + 1 < rings) enter(bin + sectors, region);
    const bool nadir = map_.grid.theta_max_rad > kPi * (1 - 1e-9);
    if (ring == 0 || (ring + 1 == rings && nadir)) enter_ring(ring, region);
  }

  void enter_ring(std::size_t ring, MapRegion& region) {
    const auto sectors = static_cast<std::size_t>(map_.grid.sectors);
    for (std::size_t s = 0; s < sectors; ++s) enter(ring * sectors + s, region);
  }

  const PolarMap& map_;
  std::vector<int> layer_;
  std::vector<bool> seen_;
};

}  // namespace

std::vector<MapRegion> regions_by_luminance(const PolarMap& map, int layers) {
  return Flood(map, layer_of_bins(map, layers)).regions();
}

}  // namespace lightwell
