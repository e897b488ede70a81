// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/ring_distribution.h"

#include "lighting/result.h"

namespace lightwell {
namespace {

// Radiance × solid angle stays finite in float up to here; beyond is no light but a broken map.
constexpr float kLargestPower = 1e30f;

// power = luminance × solid angle over one ring; returns its RGB sums.
// Sums of a few hundred non-negative floats in eight lanes: relative error ≤ 1e-5 · 2⁻⁴, no cancellation.
Rgbd weigh_ring(const float* red, const float* green, const float* blue, const float* solid_angle,
                int sectors, float* power) noexcept {
  constexpr int kLanes = 8;
  std::array<float, kLanes> sum_r{}, sum_g{}, sum_b{};
  int s = 0;
  for (; s + kLanes <= sectors; s += kLanes) {
    for (int l = 0; l < kLanes; ++l) {
      const auto lane = static_cast<std::size_t>(l);
      const float omega = solid_angle[s + l];
      const float r = red[s + l] * omega;
      const float g = green[s + l] * omega;
      const float b = blue[s + l] * omega;
      sum_r[lane] += r;
      sum_g[lane] += g;
      sum_b[lane] += b;
      power[s + l] = std::min(0.2126f * r + 0.7152f * g + 0.0722f * b, kLargestPower);
    }
  }
  Rgbd total = Rgbd::Zero();
  for (std::size_t l = 0; l < kLanes; ++l)
    total +=
        Rgbd(static_cast<double>(sum_r[l]), static_cast<double>(sum_g[l]), static_cast<double>(sum_b[l]));
  for (; s < sectors; ++s) {
    const Rgb c = Rgb(red[s], green[s], blue[s]) * solid_angle[s];
    total += c.cast<double>();
    power[s] = std::min(luminance(c), kLargestPower);
  }
  return total;
}

void weigh_ring_mono(const float* radiance, const float* solid_angle, int sectors, float* power) noexcept {
  for (int s = 0; s < sectors; ++s) power[s] = std::min(radiance[s] * solid_angle[s], kLargestPower);
}

}  // namespace

RingDistribution::RingDistribution(const PolarGrid& grid)
    : grid_(grid),
      blocks_((grid.sectors + kBlock - 1) / kBlock),
      edge_(static_cast<std::size_t>(grid.rings) + 1),
      power_(static_cast<std::size_t>(grid.rings) * static_cast<std::size_t>(blocks_ * kBlock), 0.0f),
      block_start_(static_cast<std::size_t>(grid.rings) * static_cast<std::size_t>(blocks_ + 1), 0.0),
      ring_start_(static_cast<std::size_t>(grid.rings) + 1, 0.0) {
  verify_bug(grid.rings > 0 && grid.sectors > 0, "a polar grid needs a ring and a sector");
  for (int k = 0; k <= grid.rings; ++k) {
    const double half_sine = std::sin(grid.ring_edge_rad(k) / 2);  // 1 − cos θ = 2 sin²(θ/2), exact near 0
    edge_[static_cast<std::size_t>(k)] = 2 * half_sine * half_sine;
  }
}

void RingDistribution::build(const PolarMap& map) noexcept {
  verify_bug(map.grid == grid_, "the map has another grid than the distribution");
  const bool mono = map.channels == 1;
  const auto sectors = static_cast<std::size_t>(grid_.sectors);
  const std::size_t plane = mono ? 0 : grid_.size();
  total_rgb_ = Rgbd::Zero();
  for (int ring = 0; ring < grid_.rings; ++ring) {
    const std::size_t bin = static_cast<std::size_t>(ring) * sectors;
    const float* radiance = map.radiance.data() + bin;
    float* power = power_.data() + power_index(ring, 0);
    if (mono)
      weigh_ring_mono(radiance, map.solid_angle_sr.data() + bin, grid_.sectors, power);
    else
      total_rgb_ += weigh_ring(radiance, radiance + plane, radiance + 2 * plane,
                               map.solid_angle_sr.data() + bin, grid_.sectors, power);
    double* start = block_start_.data() + block_index(ring, 0);
    double sum = 0;
    for (int block = 0; block < blocks_; ++block) {
      const float* p = power + block * kBlock;
      start[block] = sum;
      sum += static_cast<double>((p[0] + p[1]) + (p[2] + p[3])) +
             static_cast<double>((p[4] + p[5]) + (p[6] + p[7]));
    }
    start[blocks_] = sum;
    ring_start_[static_cast<std::size_t>(ring) + 1] = ring_start_[static_cast<std::size_t>(ring)] + sum;
  }
  if (mono) total_rgb_.setConstant(total_power());
}

double RingDistribution::power_before(int ring, double turns) const noexcept {
  return power_before({ring, ring, 1, 0, 0}, turns);
}

double RingDistribution::power_before(const RingBlend& blend, double turns) const noexcept {
  const double position = std::clamp(turns, 0.0, 1.0) * grid_.sectors;
  const int sector = std::min(static_cast<int>(position), grid_.sectors - 1);
  const int block = sector / kBlock;
  double sum = blend.weight_a * block_start(blend.a, block) + blend.weight_b * block_start(blend.b, block) +
               blend.uniform * (block * kBlock);
  for (int s = block * kBlock; s < sector; ++s) sum += bin_power(blend, s);
  return sum + (position - sector) * bin_power(blend, sector);
}

RingPlace RingDistribution::ring_at(double t) const noexcept {
  const double target = t * total_power();
  // Last ring whose start is ≤ target and whose power is not zero.
  const auto above = std::upper_bound(ring_start_.begin(), ring_start_.end(), target);
  int ring = std::clamp(static_cast<int>(above - ring_start_.begin()) - 1, 0, grid_.rings - 1);
  while (ring > 0 && ring_power(ring) <= 0) --ring;
  const double power = ring_power(ring);
  if (power <= 0) return {ring, 0.5};
  return {ring, std::clamp((target - ring_start(ring)) / power, 0.0, 1.0)};
}

SectorPlace RingDistribution::sector_at(const RingBlend& blend, double target) const noexcept {
  const double* a = block_start_.data() + block_index(blend.a, 0);
  const double* b = block_start_.data() + block_index(blend.b, 0);
  const auto start = [&](int block) {
    return blend.weight_a * a[block] + blend.weight_b * b[block] + blend.uniform * (block * kBlock);
  };
  // Branch-free search for the last block that starts at or before the target.
  int block = 0;
  for (int length = blocks_; length > 1;) {
    const int half = length / 2;
    block += start(block + half) <= target ? half : 0;
    length -= half;
  }
  const float* pa = power_.data() + power_index(blend.a, block * kBlock);
  const float* pb = power_.data() + power_index(blend.b, block * kBlock);
  const int width = std::min(kBlock, grid_.sectors - block * kBlock);
  double rest = target - start(block);
  for (int j = 0; j < width; ++j) {
    const double power = blend.weight_a * static_cast<double>(pa[j]) +
                         blend.weight_b * static_cast<double>(pb[j]) + blend.uniform;
    if (rest < power) return {block * kBlock + j, std::clamp(rest / power, 0.0, 1.0)};
    rest -= power;
  }
  return last_sector_with_power(blend, block * kBlock + width - 1);
}

// The target lies beyond what the block holds by a rounding error: the end of the last sector that has power.
SectorPlace RingDistribution::last_sector_with_power(const RingBlend& blend, int from_sector) const noexcept {
  for (int s = from_sector; s >= 0; --s)
    if (bin_power(blend, s) > 0) return {s, 1};
  for (int s = from_sector + 1; s < grid_.sectors; ++s)
    if (bin_power(blend, s) > 0) return {s, 0};
  return {from_sector, 0.5};
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
