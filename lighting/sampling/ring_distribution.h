// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "lighting/polar_map.h"
#include "lighting/sampling/light_kernel/kernel.h"
#include "lighting/vector.h"

namespace lightwell {

// A radiance map as a discrete distribution: the power of a bin is its luminance × its measured solid angle
// (lux). Cumulative sums stand per ring, in double, over blocks of eight sectors and over groups of eight
// blocks; inside a block they are made when asked for. So a bin beside a sun 10⁸ times as bright keeps its
// share, a frame costs one pass over the map, and a search is three steps of eight comparisons side by side.
//
// build and the queries allocate nothing and do not fail; queries are thread-safe. Azimuth is in turns from λ
// = 0.
class RingDistribution {
 public:
  static constexpr int kBlock = light_kernel::kBlock;  // sectors a block, and blocks a group

  explicit RingDistribution(const PolarGrid& grid);

  // map: of this grid, radiance finite and ≥ 0.
  void build(const PolarMap& map) noexcept;

  [[nodiscard]] const PolarGrid& grid() const { return grid_; }
  [[nodiscard]] double total_power() const { return total_power_; }  // luminance, lux
  [[nodiscard]] const Rgbd& total_illuminance() const { return total_rgb_; }
  [[nodiscard]] double ring_power(int ring) const { return ring_power_[static_cast<std::size_t>(ring)]; }
  // Power of the rings inside of this one.
  [[nodiscard]] double ring_start(int ring) const { return ring_start_[static_cast<std::size_t>(ring)]; }
  [[nodiscard]] double bin_power(int ring, int sector) const {
    return static_cast<double>(power_[power_index(ring, sector)]);
  }
  // Power of a ring's sectors before each of its blocks, [blocks()].
  [[nodiscard]] int blocks() const { return blocks_; }
  [[nodiscard]] const double* block_starts(int ring) const { return block_start_.data() + start_index(ring); }

  // Power of the ring over azimuths [0, turns), turns in [0, 1].
  [[nodiscard]] double power_before(int ring, double turns) const noexcept;
  [[nodiscard]] double power_before(const RingBlend& blend, double turns) const noexcept;
  // The same of every ring at once, [rings].
  void powers_before(double turns, std::span<double> powers) const noexcept;
  [[nodiscard]] double power(const RingBlend& blend) const noexcept {
    return blend.weight_a * ring_power(blend.a) + blend.weight_b * ring_power(blend.b) +
           blend.uniform * grid_.sectors;
  }
  [[nodiscard]] double bin_power(const RingBlend& blend, int sector) const noexcept {
    return blend.weight_a * bin_power(blend.a, sector) + blend.weight_b * bin_power(blend.b, sector) +
           blend.uniform;
  }

  // What the kernels search in: the inverse of the cumulative sums.
  [[nodiscard]] light_kernel::RingTables tables() const noexcept;

  // Zenith angle of a place as 1 − cos θ (exact near the zenith), and back.
  [[nodiscard]] double one_minus_cos(const RingPlace& place) const {
    const auto k = static_cast<std::size_t>(place.ring);
    return edge_[k] + place.fraction * (edge_[k + 1] - edge_[k]);
  }
  [[nodiscard]] RingPlace ring_of(double theta_rad) const noexcept;
  [[nodiscard]] double cap() const { return edge_.back(); }  // 1 − cos θ at the map's edge

 private:
  [[nodiscard]] std::size_t start_index(int ring) const {
    return static_cast<std::size_t>(ring) * static_cast<std::size_t>(groups_ * kBlock);
  }
  [[nodiscard]] std::size_t group_index(int ring) const {
    return static_cast<std::size_t>(ring) * static_cast<std::size_t>(group_stride_);
  }
  [[nodiscard]] std::size_t power_index(int ring, int sector) const {
    return static_cast<std::size_t>(ring) * static_cast<std::size_t>(blocks_ * kBlock) +
           static_cast<std::size_t>(sector);
  }

  PolarGrid grid_;
  int blocks_;                // of a ring
  int groups_;                // of a ring, of eight blocks
  int group_stride_;          // groups_, a multiple of 4
  std::vector<double> edge_;  // [rings + 1], 1 − cos θ
  std::vector<float> power_;  // [rings][blocks · kBlock], the last block padded with zeros
  // Starts beyond the last are the ring's power, and infinite for the rings: no search ends there but at the end.
  std::vector<double> block_start_;  // [rings][groups · kBlock]
  std::vector<double> group_start_;  // [rings][group_stride]
  std::vector<double> ring_power_;   // [rings]
  std::vector<double> ring_start_;   // [rings, to a multiple of 4]
  std::vector<double> ring_groups_;  // every light_kernel::kRingGroup-th of ring_start_, to a multiple of 4
  double total_power_ = 0;
  Rgbd total_rgb_ = Rgbd::Zero();
};

}  // namespace lightwell
