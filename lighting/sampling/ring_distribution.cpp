// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/sampling/ring_distribution.h"

#include <limits>

#include "lighting/result.h"

namespace lightwell {
namespace {

constexpr int to_multiple(int count, int of) {
  return (count + of - 1) / of * of;
}

}  // namespace

RingDistribution::RingDistribution(const PolarGrid& grid)
    : grid_(grid),
      blocks_((grid.sectors + kBlock - 1) / kBlock),
      groups_((blocks_ + kBlock - 1) / kBlock),
      group_stride_(to_multiple(groups_, 4)),
      edge_(static_cast<std::size_t>(grid.rings) + 1),
      power_(power_index(grid.rings, 0), 0.0f),
      block_start_(start_index(grid.rings), 0.0),
      group_start_(group_index(grid.rings), 0.0),
      ring_power_(static_cast<std::size_t>(grid.rings), 0.0),
      ring_start_(static_cast<std::size_t>(to_multiple(grid.rings, 4)),
                  std::numeric_limits<double>::infinity()),
      ring_groups_(static_cast<std::size_t>(to_multiple(
                       (grid.rings + light_kernel::kRingGroup - 1) / light_kernel::kRingGroup, 4)),
                   std::numeric_limits<double>::infinity()) {
  verify_bug(grid.rings > 0 && grid.sectors > 0, "a polar grid needs a ring and a sector");
  for (int k = 0; k <= grid.rings; ++k) {
    const double half_sine = std::sin(grid.ring_edge_rad(k) / 2);  // 1 − cos θ = 2 sin²(θ/2), exact near 0
    edge_[static_cast<std::size_t>(k)] = 2 * half_sine * half_sine;
  }
}

void RingDistribution::build(const PolarMap& map) noexcept {
  verify_bug(map.grid == grid_, "the map has another grid than the distribution");
  const bool mono = map.channels == 1;
  const auto weigh_ring = light_kernel::kernels().weigh_ring;
  const auto sectors = static_cast<std::size_t>(grid_.sectors);
  const std::size_t plane = mono ? 0 : grid_.size();
  total_power_ = 0;
  total_rgb_ = Rgbd::Zero();
  for (int ring = 0; ring < grid_.rings; ++ring) {
    const auto k = static_cast<std::size_t>(ring);
    const float* red = map.radiance.data() + k * sectors;
    const light_kernel::RingPlanes in = {red, red + plane, red + 2 * plane,
                                         map.solid_angle_sr.data() + k * sectors};
    double* start = block_start_.data() + start_index(ring);
    Rgbd rgb;
    weigh_ring(in, mono, grid_.sectors, power_.data() + power_index(ring, 0), start, &ring_power_[k],
               rgb.data());
    total_rgb_ += rgb;
    std::fill(start + blocks_, start + groups_ * kBlock, ring_power_[k]);
    double* group_start = group_start_.data() + group_index(ring);
    for (int g = 0; g < group_stride_; ++g) group_start[g] = g < groups_ ? start[g * kBlock] : ring_power_[k];
    ring_start_[k] = total_power_;
    if (ring % light_kernel::kRingGroup == 0) ring_groups_[k / light_kernel::kRingGroup] = total_power_;
    total_power_ += ring_power_[k];
  }
}

double RingDistribution::power_before(int ring, double turns) const noexcept {
  return power_before({ring, ring, 1, 0, 0}, turns);
}

double RingDistribution::power_before(const RingBlend& blend, double turns) const noexcept {
  const double position = std::clamp(turns, 0.0, 1.0) * grid_.sectors;
  const int sector = std::min(static_cast<int>(position), grid_.sectors - 1);
  const int block = sector / kBlock;
  double sum = blend.weight_a * block_starts(blend.a)[block] + blend.weight_b * block_starts(blend.b)[block] +
               blend.uniform * (block * kBlock);
  for (int s = block * kBlock; s < sector; ++s) sum += bin_power(blend, s);
  return sum + (position - sector) * bin_power(blend, sector);
}

void RingDistribution::powers_before(double turns, std::span<double> powers) const noexcept {
  const double position = std::clamp(turns, 0.0, 1.0) * grid_.sectors;
  const int sector = std::min(static_cast<int>(position), grid_.sectors - 1);
  const double part = position - sector;
  const int block = sector / kBlock;
  for (int ring = 0; ring < grid_.rings; ++ring) {
    double sum = block_starts(ring)[block];
    const float* power = power_.data() + power_index(ring, 0);
    for (int s = block * kBlock; s < sector; ++s) sum += static_cast<double>(power[s]);
    powers[static_cast<std::size_t>(ring)] = sum + part * static_cast<double>(power[sector]);
  }
}

light_kernel::RingTables RingDistribution::tables() const noexcept {
  return {.rings = grid_.rings,
          .sectors = grid_.sectors,
          .blocks = blocks_,
          .groups = groups_,
          .group_stride = group_stride_,
          .total_power = total_power_,
          .power = power_.data(),
          .block_start = block_start_.data(),
          .group_start = group_start_.data(),
          .ring_power = ring_power_.data(),
          .ring_start = ring_start_.data(),
          .ring_group = ring_groups_.data(),
          .ring_groups = static_cast<int>(ring_groups_.size())};
}

RingPlace RingDistribution::ring_of(double theta_rad) const noexcept {
  const double half_sine = std::sin(theta_rad / 2);
  const double h = 2 * half_sine * half_sine;
  int ring = std::clamp(static_cast<int>(theta_rad / grid_.theta_max_rad * grid_.rings), 0, grid_.rings - 1);
  if (ring > 0 && h < edge_[static_cast<std::size_t>(ring)]) --ring;  // θ on an edge, to rounding
  const double inner = edge_[static_cast<std::size_t>(ring)];
  const double outer = edge_[static_cast<std::size_t>(ring) + 1];
  return {ring, std::clamp((h - inner) / (outer - inner), 0.0, 1.0)};
}

}  // namespace lightwell
