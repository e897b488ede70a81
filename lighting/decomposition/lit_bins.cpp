// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/lit_bins.h"

#include <algorithm>
#include <cmath>

namespace lightwell {
namespace {

constexpr double kBlockSideRad = 5 * kPi / 180;

struct Azimuth {
  double sine, cosine;
};

std::vector<Azimuth> azimuths(const PolarGrid& grid) {
  std::vector<Azimuth> table;
  for (int sector = 0; sector < grid.sectors; ++sector) {
    const double lambda = 2 * kPi * (sector + 0.5) / grid.sectors;
    table.push_back({std::sin(lambda), std::cos(lambda)});
  }
  return table;
}

class Collector {
 public:
  Collector(const PolarMap& map, LitBins& bins) : map_(map), bins_(bins), azimuth_(azimuths(map.grid)) {}

  void block(int ring0, int ring1, int sector0, int sector1) {
    const std::size_t begin = bins_.size();
    Vec3d sum = Vec3d::Zero();
    for (int ring = ring0; ring < ring1; ++ring) {
      const double theta = map_.grid.theta_max_rad * (ring + 0.5) / map_.grid.rings;
      const double sine = std::sin(theta);
      const double cosine = std::cos(theta);
      for (int sector = sector0; sector < sector1; ++sector) {
        const std::size_t bin = static_cast<std::size_t>(ring) * static_cast<std::size_t>(map_.grid.sectors) +
                                static_cast<std::size_t>(sector);
        const double power = luminance(bin_illuminance(map_, bin));
        if (!(power > 0)) continue;
        const Azimuth& a = azimuth_[static_cast<std::size_t>(sector)];
        bins_.direction.emplace_back(sine * a.sine, cosine, sine * a.cosine);
        bins_.power.push_back(power);
        bins_.bin.push_back(static_cast<std::uint32_t>(bin));
        sum += bins_.direction.back();
      }
    }
    if (bins_.size() > begin) bins_.blocks.push_back(bounded(begin, sum));
  }

 private:
  [[nodiscard]] LitBins::Block bounded(std::size_t begin, const Vec3d& sum) const {
    const double length = sum.norm();  // a ring round the zenith may cancel
    LitBins::Block block = {begin, bins_.size(), length > 1e-9 ? Vec3d(sum / length) : bins_.direction[begin],
                            0};
    for (std::size_t i = begin; i < bins_.size(); ++i)
      block.radius = std::max(block.radius, (bins_.direction[i] - block.centre).norm());
    return block;
  }

  const PolarMap& map_;
  LitBins& bins_;
  std::vector<Azimuth> azimuth_;
};

}  // namespace

LitBins lit_bins(const PolarMap& map) {
  LitBins bins;
  Collector collector(map, bins);
  const PolarGrid& grid = map.grid;
  const double ring_height = grid.theta_max_rad / grid.rings;
  const int rings = std::max(1, static_cast<int>(std::lround(kBlockSideRad / ring_height)));
  for (int ring = 0; ring < grid.rings; ring += rings) {
    const int ring_end = std::min(grid.rings, ring + rings);
    const double width = 2 * kPi / grid.sectors * std::sin(ring_height * (ring + ring_end) / 2);
    const double wanted = std::clamp(kBlockSideRad / width, 1.0, static_cast<double>(grid.sectors));
    const int sectors = static_cast<int>(std::lround(wanted));
    for (int sector = 0; sector < grid.sectors; sector += sectors)
      collector.block(ring, ring_end, sector, std::min(grid.sectors, sector + sectors));
  }
  double total = 0;
  for (const double power : bins.power) total += power;
  for (double& power : bins.power) power /= total;
  return bins;
}

}  // namespace lightwell
