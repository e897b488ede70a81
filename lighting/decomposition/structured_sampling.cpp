// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/structured_sampling.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>

#include "lighting/decomposition/cell_powers.h"
#include "lighting/decomposition/lit_bins.h"
#include "lighting/decomposition/map_regions.h"
#include "lighting/decomposition/uniform_lights.h"
#include "lighting/decomposition/voronoi_cells.h"

namespace lightwell {
namespace {

constexpr int kLayers = 6;              // the paper's d (section 4.1)
constexpr double kAreaExponent = 0.25;  // the paper's b; a = 1 (section 3.2)

// `count` shared out in proportion to the weights, at most `room` each, by the largest remainder.
std::vector<std::size_t> shares(const std::vector<double>& weights, const std::vector<std::size_t>& room,
                                std::size_t count) {
  std::vector<std::size_t> share(weights.size(), 0);
  std::vector<std::size_t> open(weights.size());
  std::iota(open.begin(), open.end(), std::size_t{0});
  const auto scale = [&] {
    double weight = 0;
    for (const std::size_t i : open) weight += weights[i];
    return static_cast<double>(count) / weight;
  };
  // Full regions leave what they cannot hold to the others.
  for (bool filled = true; filled && !open.empty();) {
    const double per_weight = scale();
    filled = std::erase_if(open, [&](std::size_t i) {
               if (weights[i] * per_weight < static_cast<double>(room[i])) return false;
               share[i] = std::min(room[i], count);
               count -= share[i];
               return true;
             }) > 0;
  }
  std::vector<double> remainder(weights.size(), 0);
  const double per_weight = scale();
  for (const std::size_t i : open) {
    share[i] = std::min(count, static_cast<std::size_t>(weights[i] * per_weight));
    remainder[i] = weights[i] * per_weight - static_cast<double>(share[i]);
  }
  for (const std::size_t i : open) count -= std::min(count, share[i]);
  std::stable_sort(open.begin(), open.end(),
                   [&](std::size_t a, std::size_t b) { return remainder[a] > remainder[b]; });
  for (std::size_t k = 0; k < open.size() && count > 0; ++k, --count) ++share[open[k]];
  return share;
}

class Strata {
 public:
  Strata(const PolarMap& map, const LitBins& bins)
      : bins_(bins), cells_(bins), lit_(map.grid.size(), 0), regions_(regions_by_luminance(map, kLayers)) {
    for (std::size_t i = 0; i < bins.size(); ++i) lit_[bins.bin[i]] = static_cast<std::uint32_t>(i);
  }

  std::vector<DirectionalLight> lights(const PolarMap& map, std::size_t count) {
    std::vector<double> importance;
    std::vector<std::size_t> room;
    for (const MapRegion& region : regions_) {
      importance.push_back(region.luminance * std::pow(region.solid_angle_sr, kAreaExponent));
      room.push_back(region.bins.size());
    }
    const std::vector<std::size_t> share = shares(importance, room, count);
    for (std::size_t r = 0; r < regions_.size(); ++r)
      for (std::size_t k = 0; k < share[r]; ++k)
        cells_.add(k == 0 ? middle(regions_[r]) : farthest(regions_[r]));
    return lights_at_means(map, bins_, cells_);
  }

 private:
  // The bin nearest to the region's luminance-weighted mean.
  [[nodiscard]] Vec3d middle(const MapRegion& region) const {
    Vec3d moment = Vec3d::Zero();
    for (const std::uint32_t bin : region.bins) moment += bins_.power[lit_[bin]] * bins_.direction[lit_[bin]];
    const auto nearer = [&](std::uint32_t a, std::uint32_t b) {
      return bins_.direction[lit_[a]].dot(moment) < bins_.direction[lit_[b]].dot(moment);
    };
    return bins_.direction[lit_[*std::max_element(region.bins.begin(), region.bins.end(), nearer)]];
  }

  // The region's bin farthest from every light so far.
  [[nodiscard]] Vec3d farthest(const MapRegion& region) const {
    const auto nearer = [&](std::uint32_t a, std::uint32_t b) {
      return cells_.cosine(lit_[a]) < cells_.cosine(lit_[b]);
    };
    return bins_.direction[lit_[*std::min_element(region.bins.begin(), region.bins.end(), nearer)]];
  }

  const LitBins& bins_;
  VoronoiCells cells_;
  std::vector<std::uint32_t> lit_;  // index in LitBins of the map's bins
  std::vector<MapRegion> regions_;
};

}  // namespace

std::vector<DirectionalLight> structured_sampling(const PolarMap& map, int count) {
  const LitBins bins = lit_bins(map);
  if (bins.empty()) return dark_lights(map.grid, count);
  auto lights = Strata(map, bins).lights(map, static_cast<std::size_t>(count));
  DirectionalLight dark = lights.front();
  dark.illuminance = Rgb::Zero();
  lights.resize(static_cast<std::size_t>(count), dark);
  return lights;
}

}  // namespace lightwell
