// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/sampling/azimuth_seam.h"

#include <algorithm>
#include <cmath>

namespace lightwell {
namespace {

double wrap_turns(double x) {
  x -= std::floor(x);
  return x < 1 ? x : 0;
}

// Signed way around the circle, in [−½, ½].
double turns_between(double from, double to) {
  const double d = to - from;
  return d - std::round(d);
}

void add_to(double* __restrict sums, const double* __restrict values, std::size_t count) noexcept {
  for (std::size_t i = 0; i < count; ++i) sums[i] += values[i];
}

}  // namespace

// Σ energy · ((1 + cos Δλ)/2)² / Σ energy = ⅜ + ½ Re(e^{−iλ} m1) + ⅛ Re(e^{−2iλ} m2), m the circular moments:
// 0 to 1.
struct AzimuthSeam::NearEnergy {
  std::complex<double> m1, m2;
  // e = e^{−iλ}; written out, because C++'s complex product must care for infinities
  [[nodiscard]] double at(const std::complex<double>& e) const {
    const double c2 = e.real() * e.real() - e.imag() * e.imag();
    const double s2 = 2 * e.real() * e.imag();
    return 0.375 + 0.5 * (e.real() * m1.real() - e.imag() * m1.imag()) +
           0.125 * (c2 * m2.real() - s2 * m2.imag());
  }
  [[nodiscard]] double at(double turns) const { return at(std::polar(1.0, -2 * kPi * turns)); }
};

AzimuthSeam::AzimuthSeam(const PolarGrid& grid)
    : sectors_(grid.sectors),
      seam_power_(static_cast<std::size_t>(grid.rings), 0.0),
      shares_(static_cast<std::size_t>(grid.rings)),
      column_start_(
          static_cast<std::size_t>((grid.sectors + RingDistribution::kBlock - 1) / RingDistribution::kBlock) +
          1) {
  for (std::size_t b = 0; b + 1 < column_start_.size(); ++b) {
    const auto first = static_cast<double>(b * RingDistribution::kBlock);
    const double last = std::min(first + RingDistribution::kBlock, static_cast<double>(grid.sectors));
    block_azimuth_.push_back(std::polar(1.0, 2 * kPi * (first + last) / 2 / grid.sectors));
  }
  constexpr int kCandidates = 72;  // 5°, far finer than the kernel
  for (int i = 0; i < kCandidates; ++i) candidates_.push_back(std::polar(1.0, -2 * kPi * i / kCandidates));
}

void AzimuthSeam::reset() noexcept {
  placed_ = false;
  turns_ = 0;
  offset_ = 0;
}

void AzimuthSeam::fix(const RingDistribution& map, double turns) noexcept {
  turns_ = wrap_turns(turns);
  offset_ = 0;
  update_seam_power(map);
}

AzimuthSeam::NearEnergy AzimuthSeam::near_energy(const RingDistribution& map) noexcept {
  std::fill(column_start_.begin(), column_start_.end(), 0.0);
  const std::size_t blocks = column_start_.size() - 1;
  for (int ring = 0; ring < map.grid().rings; ++ring)
    add_to(column_start_.data(), map.block_starts(ring), blocks);
  column_start_[blocks] = map.total_power();
  NearEnergy near{};
  for (std::size_t b = 0; b < block_azimuth_.size(); ++b) {
    const std::complex<double> e = block_azimuth_[b];
    const double share = (column_start_[b + 1] - column_start_[b]) / map.total_power();
    near.m1 += share * e;
    near.m2 +=
        share * std::complex<double>(e.real() * e.real() - e.imag() * e.imag(), 2 * e.real() * e.imag());
  }
  return near;
}

void AzimuthSeam::follow(const RingDistribution& map) noexcept {
  if (map.total_power() > 0) {
    const NearEnergy near = near_energy(map);
    double least = 2, most = 0, best = 0;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      const double energy = near.at(candidates_[i]);
      most = std::max(most, energy);
      if (energy < least) {
        least = energy;
        best = static_cast<double>(i) / static_cast<double>(candidates_.size());
      }
    }
    constexpr double kFlat = 0.02;  // a map this even in azimuth gives the seam no reason to move
    const double level = least + 0.25 * (most - least);
    if (!placed_) {
      turns_ = best;
      placed_ = true;
    } else if (most - least > kFlat && near.at(turns_) > level && !slide(near, level)) {
      jump(map, best);
    }
  }
  update_seam_power(map);
}

// To the nearest place at the level, on either side; false where there is none within 30°.
bool AzimuthSeam::slide(const NearEnergy& near, double level) noexcept {
  constexpr double kStep = 0.5 / 360;
  constexpr int kSteps = 60;
  for (int i = 1; i <= kSteps; ++i) {
    for (const double side : {1.0, -1.0}) {
      if (near.at(turns_ + side * i * kStep) > level) continue;
      double above = (i - 1) * kStep, below = i * kStep;
      for (int halvings = 0; halvings < 30; ++halvings) {
        const double middle = (above + below) / 2;
        (near.at(turns_ + side * middle) <= level ? below : above) = middle;
      }
      turns_ = wrap_turns(turns_ + side * below);
      return true;
    }
  }
  return false;
}

void AzimuthSeam::jump(const RingDistribution& map, double turns) noexcept {
  const double arc = turns_between(turns_, turns);
  const double from = arc < 0 ? turns : turns_;
  const double to = arc < 0 ? turns_ : turns;
  double total = 0;
  for (int ring = 0; ring < map.grid().rings; ++ring) {
    const double power = map.ring_power(ring);
    double over = map.power_before(ring, to) - map.power_before(ring, from);
    if (over < 0) over += power;  // the arc holds λ = 0
    shares_[static_cast<std::size_t>(ring)] = {power > 0 ? over / power : 0, power};
    total += power;
  }
  std::sort(shares_.begin(), shares_.end(), [](const Share& p, const Share& q) { return p.share < q.share; });
  double sum = 0;
  double median = 0;
  for (const Share& s : shares_) {
    sum += s.power;
    median = s.share;
    if (sum >= total / 2) break;
  }
  offset_ = wrap_turns(offset_ + (arc < 0 ? -median : median));
  turns_ = turns;
}

void AzimuthSeam::update_seam_power(const RingDistribution& map) noexcept {
  map.powers_before(turns_, seam_power_);
}

double AzimuthSeam::power_target(const RingDistribution& map, const RingBlend& blend,
                                 double s) const noexcept {
  return light_kernel::kernels().target(map.tables(), tables(), blend, s);
}

double AzimuthSeam::place(const RingDistribution& map, const RingBlend& blend,
                          double power_before) const noexcept {
  const double power = map.power(blend);
  if (power <= 0) return offset_;
  return wrap_turns((power_before - seam_power(blend)) / power + offset_);
}

}  // namespace lightwell
