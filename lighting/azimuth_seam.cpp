// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/azimuth_seam.h"

#include <algorithm>
#include <cmath>
#include <complex>

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

}  // namespace

// Σ energy · ((1 + cos Δλ)/2)² / Σ energy = ⅜ + ½ Re(e^{−iλ} m1) + ⅛ Re(e^{−2iλ} m2), m the circular moments:
// 0 to 1.
struct AzimuthSeam::NearEnergy {
  std::complex<double> m1, m2;
  double at(double turns) const {
    const auto e = std::polar(1.0, -2 * kPi * turns);
    return 0.375 + 0.5 * (e * m1).real() + 0.125 * (e * e * m2).real();
  }
};

AzimuthSeam::AzimuthSeam(const PolarGrid& grid)
    : sectors_(grid.sectors),
      seam_power_(static_cast<std::size_t>(grid.rings), 0.0),
      shares_(static_cast<std::size_t>(grid.rings)),
      column_start_(
          static_cast<std::size_t>((grid.sectors + RingDistribution::kBlock - 1) / RingDistribution::kBlock) +
          1) {}

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

void AzimuthSeam::follow(const RingDistribution& map) noexcept {
  const int blocks = map.blocks();
  std::fill(column_start_.begin(), column_start_.end(), 0.0);
  for (int ring = 0; ring < map.grid().rings; ++ring)
    for (int b = 0; b <= blocks; ++b) column_start_[static_cast<std::size_t>(b)] += map.block_start(ring, b);

  const double total = map.total_power();
  if (total > 0) {
    NearEnergy near{};
    for (int b = 0; b < blocks; ++b) {
      const auto i = static_cast<std::size_t>(b);
      const double last = std::min((b + 1) * RingDistribution::kBlock, sectors_);
      const double middle = (b * RingDistribution::kBlock + last) / 2 / sectors_;
      const auto e = std::polar(1.0, 2 * kPi * middle);
      const double share = (column_start_[i + 1] - column_start_[i]) / total;
      near.m1 += share * e;
      near.m2 += share * e * e;
    }
    constexpr int kSteps = 72;  // 5°, far finer than the kernel
    double least = 2, most = 0, best = 0;
    for (int i = 0; i < kSteps; ++i) {
      const double x = static_cast<double>(i) / kSteps;
      const double energy = near.at(x);
      most = std::max(most, energy);
      if (energy < least) {
        least = energy;
        best = x;
      }
    }
    constexpr double kFlat = 0.02;  // a map this even in azimuth gives the seam no reason to move
    if (!placed_) {
      turns_ = best;
      placed_ = true;
    } else if (const double level = least + 0.25 * (most - least);
               most - least > kFlat && near.at(turns_) > level) {
      // The nearest place at the level, on either side; steps of half a degree, refined by bisection.
      constexpr double kStep = 0.5 / 360;
      constexpr int kSlide = 60;  // 30°
      int reached = 0;
      double side = 1;
      for (int i = 1; i <= kSlide && reached == 0; ++i)
        for (const double direction : {1.0, -1.0})
          if (reached == 0 && near.at(turns_ + direction * i * kStep) <= level) {
            reached = i;
            side = direction;
          }
      if (reached == 0) {
        jump(map, best);
      } else {
        double above = (reached - 1) * kStep, below = reached * kStep;
        for (int i = 0; i < 30; ++i) {
          const double middle = (above + below) / 2;
          (near.at(turns_ + side * middle) <= level ? below : above) = middle;
        }
        turns_ = wrap_turns(turns_ + side * below);
      }
    }
  }
  update_seam_power(map);
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
  for (int ring = 0; ring < map.grid().rings; ++ring)
    seam_power_[static_cast<std::size_t>(ring)] = map.power_before(ring, turns_);
}

double AzimuthSeam::seam_power(const RingBlend& blend) const noexcept {
  return blend.weight_a * seam_power_[static_cast<std::size_t>(blend.a)] +
         blend.weight_b * seam_power_[static_cast<std::size_t>(blend.b)] + blend.uniform * turns_ * sectors_;
}

double AzimuthSeam::power_target(const RingDistribution& map, const RingBlend& blend,
                                 double s) const noexcept {
  double from_seam = s - offset_;
  if (from_seam < 0) from_seam += 1;
  const double power = map.power(blend);
  const double target = seam_power(blend) + from_seam * power;
  return target >= power ? target - power : target;
}

double AzimuthSeam::place(const RingDistribution& map, const RingBlend& blend,
                          double power_before) const noexcept {
  const double power = map.power(blend);
  if (power <= 0) return offset_;
  return wrap_turns((power_before - seam_power(blend)) / power + offset_);
}

}  // namespace lightwell
