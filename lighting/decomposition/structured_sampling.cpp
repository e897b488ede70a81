// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/structured_sampling.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numeric>
#include <queue>
#include <utility>

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

// A region's bins by their distance from the nearest light so far. Lights only come nearer, so an entry that is
// out of date is too far up, and is put where it belongs when it comes to the top.
class FarthestBin {
 public:
  FarthestBin(const VoronoiCells& cells, std::vector<std::uint32_t> bins) : cells_(cells) {
    std::vector<Entry> entries;
    for (const std::uint32_t bin : bins) entries.push_back({cells.cosine(bin), bin});
    queue_ = std::priority_queue<Entry>(std::less<Entry>(), std::move(entries));
  }

  std::uint32_t find() {
    for (;;) {
      const Entry top = queue_.top();
      const double cosine = cells_.cosine(top.bin);
      if (cosine == top.cosine) return top.bin;
      queue_.pop();
      queue_.push({cosine, top.bin});
    }
  }

 private:
  struct Entry {
    double cosine;
    std::uint32_t bin;
    bool operator<(
        const Entry& other) const {  // the queue has the largest on top: the least cosine, the first bin
      return cosine != other.cosine ? cosine > other.cosine : bin > other.bin;
    }
  };
  const VoronoiCells& cells_;
  std::priority_queue<Entry> queue_;
};

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
      if (share[r] > 0) place(regions_[r], share[r]);
    return lights_at_means(map, bins_, cells_);
  }

 private:
  void place(const MapRegion& region, std::size_t count) {
    std::vector<std::uint32_t> bins;
    for (const std::uint32_t bin : region.bins) bins.push_back(lit_[bin]);
    cells_.add(bins_.direction[middle(bins)]);
    if (count == 1) return;
    FarthestBin farthest(cells_, std::move(bins));
    for (std::size_t k = 1; k < count; ++k) cells_.add(bins_.direction[farthest.find()]);
  }

  // The bin nearest to their luminance-weighted mean.
  [[nodiscard]] std::uint32_t middle(const std::vector<std::uint32_t>& bins) const {
    Vec3d moment = Vec3d::Zero();
    for (const std::uint32_t bin : bins) moment += bins_.power[bin] * bins_.direction[bin];
    return *std::max_element(bins.begin(), bins.end(), [&](std::uint32_t a, std::uint32_t b) {
      return bins_.direction[a].dot(moment) < bins_.direction[b].dot(moment);
    });
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
