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
#include "lighting/vector.h"

namespace lightwell {

// Two rings of a map and the weight of each: the conditional distribution of azimuth is that of
// weight_a · power of a + weight_b · power of b + uniform (power a sector).
struct RingBlend {
  int a = 0;
  int b = 0;
  double weight_a = 1;
  double weight_b = 0;
  double uniform = 0;
};

// A place inside a ring: fraction of the ring's solid angle, counted from its inner edge, in [0, 1].
struct RingPlace {
  int ring = 0;
  double fraction = 0;
};

// A place inside a sector: fraction of its width, in [0, 1].
struct SectorPlace {
  int sector = 0;
  double fraction = 0;
};

// A radiance map as a discrete distribution: the power of a bin is its luminance × its measured solid angle
// (lux). Cumulative sums stand per ring, in double, over blocks of eight sectors; inside a block they are
// made when asked for. So a bin beside a sun 10⁸ times as bright keeps its share, and a frame costs one pass
// over the map.
//
// build and the queries allocate nothing and do not fail; queries are thread-safe. Azimuth is in turns from λ
// = 0.
class RingDistribution {
 public:
  static constexpr int kBlock = 8;

  explicit RingDistribution(const PolarGrid& grid);

  // map: of this grid, radiance finite and ≥ 0.
  void build(const PolarMap& map) noexcept;

  [[nodiscard]] const PolarGrid& grid() const { return grid_; }
  [[nodiscard]] double total_power() const { return ring_start_.back(); }  // luminance, lux
  [[nodiscard]] const Rgbd& total_illuminance() const { return total_rgb_; }
  [[nodiscard]] double ring_power(int ring) const { return ring_power_[static_cast<std::size_t>(ring)]; }
  // Power of the rings inside of this one.
  [[nodiscard]] double ring_start(int ring) const { return ring_start_[static_cast<std::size_t>(ring)]; }
  [[nodiscard]] double bin_power(int ring, int sector) const {
    return static_cast<double>(power_[power_index(ring, sector)]);
  }
  [[nodiscard]] int blocks() const { return blocks_; }
  // Power of a ring's sectors before this block; block = blocks() gives the ring's power.
  [[nodiscard]] double block_start(int ring, int block) const {
    return block_start_[block_index(ring, block)];
  }

  // Power of the ring over azimuths [0, turns), turns in [0, 1].
  [[nodiscard]] double power_before(int ring, double turns) const noexcept;
  [[nodiscard]] double power_before(const RingBlend& blend, double turns) const noexcept;
  [[nodiscard]] double power(const RingBlend& blend) const noexcept {
    return blend.weight_a * ring_power(blend.a) + blend.weight_b * ring_power(blend.b) +
           blend.uniform * grid_.sectors;
  }
  [[nodiscard]] double bin_power(const RingBlend& blend, int sector) const noexcept {
    return blend.weight_a * bin_power(blend.a, sector) + blend.weight_b * bin_power(blend.b, sector) +
           blend.uniform;
  }

  // Inverse of the rings' cumulative power: t in [0, 1] of the total. Always a ring with power, if there is
  // one.
  [[nodiscard]] RingPlace ring_at(double t) const noexcept;
  // Inverse of power_before: the sector where the blend's cumulative power reaches `target`, in [0,
  // power(blend)]. Always a sector with power, if there is one.
  [[nodiscard]] SectorPlace sector_at(const RingBlend& blend, double target) const noexcept;
  // The same for kTogether at once: the searches run in step, so that none waits for its own loads alone.
  static constexpr std::size_t kTogether = 8;
  void rings_at(const std::array<double, kTogether>& t,
                std::array<RingPlace, kTogether>& places) const noexcept;
  void sectors_at(const std::array<RingBlend, kTogether>& blends,
                  const std::array<double, kTogether>& targets,
                  std::array<SectorPlace, kTogether>& places) const noexcept;

  // Zenith angle of a place as 1 − cos θ (exact near the zenith), and back.
  [[nodiscard]] double one_minus_cos(const RingPlace& place) const {
    const auto k = static_cast<std::size_t>(place.ring);
    return edge_[k] + place.fraction * (edge_[k + 1] - edge_[k]);
  }
  [[nodiscard]] RingPlace ring_of(double theta_rad) const noexcept;
  [[nodiscard]] double cap() const { return edge_.back(); }  // 1 − cos θ at the map's edge

 private:
  [[nodiscard]] std::size_t block_index(int ring, int block) const {
    return static_cast<std::size_t>(ring) * static_cast<std::size_t>(blocks_ + 1) +
           static_cast<std::size_t>(block);
  }
  [[nodiscard]] std::size_t power_index(int ring, int sector) const {
    return static_cast<std::size_t>(ring) * static_cast<std::size_t>(blocks_ * kBlock) +
           static_cast<std::size_t>(sector);
  }
  template <std::size_t kCount>
  void find_rings(const double* t, RingPlace* places) const noexcept;
  template <std::size_t kCount, bool kUniform>
  void find_sectors(const RingBlend* blends, const double* targets, SectorPlace* places) const noexcept;
  template <bool kUniform>
  [[nodiscard]] SectorPlace find_in_block(const RingBlend& blend, int block, double rest) const noexcept;
  [[nodiscard]] SectorPlace last_sector_with_power(const RingBlend& blend, int from_sector) const noexcept;

  PolarGrid grid_;
  int blocks_;
  std::vector<double> edge_;         // [rings + 1], 1 − cos θ
  std::vector<float> power_;         // [rings][blocks · kBlock], the last block padded with zeros
  std::vector<double> block_start_;  // [rings][blocks + 1]
  std::vector<double> ring_power_;   // [rings]
  std::vector<double> ring_start_;   // [rings + 1]
  Rgbd total_rgb_ = Rgbd::Zero();
};

}  // namespace lightwell
