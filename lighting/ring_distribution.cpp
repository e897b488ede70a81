// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/ring_distribution.h"

#include <cstring>

#include "lighting/result.h"

namespace lightwell {
namespace {

// Radiance × solid angle stays finite in float up to here; beyond is no light but a broken map.
constexpr float kLargestPower = 1e30f;

// Four floats that GCC and Clang keep in one register of any machine.
using Lanes = float __attribute__((vector_size(16)));

Lanes load(const float* p) noexcept {
  Lanes v;
  std::memcpy(&v, p, sizeof v);
  return v;
}

void store(float* p, Lanes v) noexcept {
  std::memcpy(p, &v, sizeof v);
}

Lanes at_most(Lanes v, float limit) noexcept {
  const Lanes l = {limit, limit, limit, limit};
  return v < l ? v : l;
}

double sum_of_lanes(Lanes v) noexcept {
  return static_cast<double>(v[0] + v[2]) + static_cast<double>(v[1] + v[3]);
}

// The planes of one ring. red, green and blue are one plane where the map is monochrome.
struct RingPlanes {
  const float* red;
  const float* green;
  const float* blue;
  const float* solid_angle;
};

// power = luminance × solid angle over one ring, and its running sums over blocks; returns the ring's RGB
// sums, or for kMono its power thrice. Sums of a few hundred non-negative floats in four lanes: relative
// error ≤ 100 · 2⁻²⁴.
template <bool kMono>
Rgbd weigh_ring(const RingPlanes& in, int sectors, float* power, double* block_start) noexcept {
  constexpr int kBlock = RingDistribution::kBlock;
  Lanes sum_r = {}, sum_g = {}, sum_b = {};
  double sum = 0;
  int s = 0;
  for (; s + kBlock <= sectors; s += kBlock) {
    Lanes block = {};
    for (int half = s; half < s + kBlock; half += 4) {
      const Lanes omega = load(in.solid_angle + half);
      const Lanes r = load(in.red + half) * omega;
      Lanes p = r;
      if constexpr (!kMono) {
        const Lanes g = load(in.green + half) * omega;
        const Lanes b = load(in.blue + half) * omega;
        sum_r += r;
        sum_g += g;
        sum_b += b;
        p = 0.2126f * r + 0.7152f * g + 0.0722f * b;
      }
      p = at_most(p, kLargestPower);
      store(power + half, p);
      block += p;
    }
    *block_start++ = sum;
    sum += sum_of_lanes(block);
  }
  Rgbd total(sum_of_lanes(sum_r), sum_of_lanes(sum_g), sum_of_lanes(sum_b));
  if (s < sectors) *block_start++ = sum;
  for (; s < sectors; ++s) {  // the last, shorter block
    const Rgb c = Rgb(in.red[s], in.green[s], in.blue[s]) * in.solid_angle[s];
    total += c.cast<double>();
    power[s] = std::min(kMono ? c[0] : luminance(c), kLargestPower);
    sum += static_cast<double>(power[s]);
  }
  *block_start = sum;
  return kMono ? Rgbd::Constant(sum) : total;
}

}  // namespace

RingDistribution::RingDistribution(const PolarGrid& grid)
    : grid_(grid),
      blocks_((grid.sectors + kBlock - 1) / kBlock),
      edge_(static_cast<std::size_t>(grid.rings) + 1),
      power_(static_cast<std::size_t>(grid.rings) * static_cast<std::size_t>(blocks_ * kBlock), 0.0f),
      block_start_(static_cast<std::size_t>(grid.rings) * static_cast<std::size_t>(blocks_ + 1), 0.0),
      ring_power_(static_cast<std::size_t>(grid.rings), 0.0),
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
    const float* red = map.radiance.data() + bin;
    const RingPlanes in = {red, red + plane, red + 2 * plane, map.solid_angle_sr.data() + bin};
    float* power = power_.data() + power_index(ring, 0);
    double* start = block_start_.data() + block_index(ring, 0);
    total_rgb_ += mono ? weigh_ring<true>(in, grid_.sectors, power, start)
                       : weigh_ring<false>(in, grid_.sectors, power, start);
    const auto k = static_cast<std::size_t>(ring);
    ring_power_[k] = start[blocks_];
    ring_start_[k + 1] = ring_start_[k] + ring_power_[k];
  }
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

template <std::size_t kCount>
void RingDistribution::find_rings(const double* t, RingPlace* places) const noexcept {
  const double* start = ring_start_.data();
  std::array<double, kCount> target;
  std::array<int, kCount> found{};
  for (std::size_t i = 0; i < kCount; ++i) target[i] = t[i] * total_power();
  // Branch-free search for the last ring that starts at or before the target.
  for (int length = grid_.rings; length > 1;) {
    const int half = length / 2;
    for (std::size_t i = 0; i < kCount; ++i) {
      const int probe = found[i] + half;
      found[i] = start[probe] <= target[i] ? probe : found[i];
    }
    length -= half;
  }
  for (std::size_t i = 0; i < kCount; ++i) {
    int ring = found[i];
    while (ring > 0 && ring_power(ring) <= 0) --ring;
    const double power = ring_power(ring);
    places[i] = {ring, power > 0 ? std::clamp((target[i] - start[ring]) / power, 0.0, 1.0) : 0.5};
  }
}

template <std::size_t kCount, bool kUniform>
void RingDistribution::find_sectors(const RingBlend* blends, const double* targets,
                                    SectorPlace* places) const noexcept {
  std::array<const double*, kCount> a, b;
  std::array<int, kCount> found{};
  for (std::size_t i = 0; i < kCount; ++i) {
    a[i] = block_start_.data() + block_index(blends[i].a, 0);
    b[i] = block_start_.data() + block_index(blends[i].b, 0);
  }
  const auto start = [&](std::size_t i, int block) {
    const double sum = blends[i].weight_a * a[i][block] + blends[i].weight_b * b[i][block];
    if constexpr (kUniform)
      return sum + blends[i].uniform * (block * kBlock);
    else
      return sum;
  };
  // Branch-free search for the last block that starts at or before the target.
  for (int length = blocks_; length > 1;) {
    const int half = length / 2;
    for (std::size_t i = 0; i < kCount; ++i) {
      const int probe = found[i] + half;
      found[i] = start(i, probe) <= targets[i] ? probe : found[i];
    }
    length -= half;
  }
  for (std::size_t i = 0; i < kCount; ++i)
    places[i] = find_in_block<kUniform>(blends[i], found[i], targets[i] - start(i, found[i]));
}

// rest: the target less the block's start
template <bool kUniform>
SectorPlace RingDistribution::find_in_block(const RingBlend& blend, int block, double rest) const noexcept {
  const float* a = power_.data() + power_index(blend.a, block * kBlock);
  const float* b = power_.data() + power_index(blend.b, block * kBlock);
  std::array<double, kBlock> power;
  for (std::size_t j = 0; j < kBlock; ++j) {
    power[j] = blend.weight_a * static_cast<double>(a[j]) + blend.weight_b * static_cast<double>(b[j]);
    if constexpr (kUniform) power[j] += blend.uniform;
  }
  // Running sums (padding has no power), and how many of them the target has passed.
  std::array<double, kBlock + 1> sum;
  sum[0] = 0;
  int passed = 0;
  for (std::size_t j = 0; j < kBlock; ++j) {
    sum[j + 1] = sum[j] + power[j];
    passed += sum[j + 1] <= rest ? 1 : 0;
  }
  const int sector = block * kBlock + passed;
  if (passed == kBlock || sector >= grid_.sectors)
    return last_sector_with_power(blend, std::min(sector, grid_.sectors) - 1);
  const auto j = static_cast<std::size_t>(passed);
  return {sector, std::clamp((rest - sum[j]) / power[j], 0.0, 1.0)};
}

RingPlace RingDistribution::ring_at(double t) const noexcept {
  RingPlace place;
  find_rings<1>(&t, &place);
  return place;
}

void RingDistribution::rings_at(const std::array<double, kTogether>& t,
                                std::array<RingPlace, kTogether>& places) const noexcept {
  find_rings<kTogether>(t.data(), places.data());
}

SectorPlace RingDistribution::sector_at(const RingBlend& blend, double target) const noexcept {
  SectorPlace place;
  if (blend.uniform > 0)
    find_sectors<1, true>(&blend, &target, &place);
  else
    find_sectors<1, false>(&blend, &target, &place);
  return place;
}

void RingDistribution::sectors_at(const std::array<RingBlend, kTogether>& blends,
                                  const std::array<double, kTogether>& targets,
                                  std::array<SectorPlace, kTogether>& places) const noexcept {
  const bool uniform =
      std::any_of(blends.begin(), blends.end(), [](const RingBlend& b) { return b.uniform > 0; });
  if (uniform)
    find_sectors<kTogether, true>(blends.data(), targets.data(), places.data());
  else
    find_sectors<kTogether, false>(blends.data(), targets.data(), places.data());
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
