// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/ray_consistency.h"

#include <algorithm>
#include <cmath>

#include "lighting/field/moving_least_squares.h"
#include "lighting/median.h"
#include "lighting/result.h"

namespace lightwell {
namespace {

constexpr std::size_t kFewest = 8;     // rays of a direction, below which none can be said to be the odd one
constexpr double kTimesMedian = 6;     // of a Gaussian's errors one in 20,000 lies beyond
constexpr double kPartOfLight = 0.05;  // less is what optics and cells of directions add
constexpr double kMostContradicting = 1.0 / 3;
constexpr std::size_t kFewestRays = 8;  // of a probe
constexpr float kClose_cells = 0.25f;
constexpr std::size_t kFewestPairs = 100;

double energy(const Eigen::Array3f& radiance) {
  return static_cast<double>(radiance.square().sum());
}

}  // namespace

void RayConsistency::add(NearestSamples& samples, std::span<const Rgb> radiance, int support) {
  verify_bug(radiance.size() == rays_.size(), "one radiance a probe");
  const auto rays = samples.samples();
  if (rays.size() < kFewest) return;
  std::vector<double> errors(rays.size());
  double square = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto fit = foretell(samples, i, support);
    errors[i] = fit ? std::sqrt(energy(fit->radiance - rays[i].radiance)) : 0;
    square += energy(rays[i].radiance);
    // Itself and the nearest other: which of the two is not known, so that one of them is this ray or lies upon it.
    const auto near = samples.find(rays[i].at, 2);
    for (std::size_t n = 0; n < std::min<std::size_t>(2, near.size()); ++n) {
      const std::uint32_t other = near[n].sample;
      if (other <= i || near[n].square_distance > kClose_cells * kClose_cells) continue;
      ++close_pairs_;
      square_difference_ += energy(rays[i].radiance - rays[other].radiance);
      square_radiance_ += (energy(rays[i].radiance) + energy(rays[other].radiance)) / 2;
    }
  }
  if (!(square > 0)) return;
  const double most = std::max(kTimesMedian * median(errors),
                               kPartOfLight * std::sqrt(square / static_cast<double>(rays.size())));
  const auto is_worst_around = [&](std::size_t sample) {
    const auto near = samples.find(rays[sample].at, static_cast<std::size_t>(support) + 1);
    const std::size_t count = std::min(near.size(), static_cast<std::size_t>(support) + 1);
    return std::none_of(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count),
                        [&](const auto& other) { return errors[other.sample] > errors[sample]; });
  };
  std::size_t sample = 0;
  for (std::size_t probe = 0; probe < rays_.size(); ++probe) {
    if (std::isnan(radiance[probe].x())) continue;
    ++rays_[probe];
    if (errors[sample] > most && is_worst_around(sample)) ++contradicting_[probe];
    ++sample;
  }
  verify_bug(sample == rays.size(), "samples of the probes that saw the direction");
}

std::vector<DoubtfulProbe> RayConsistency::doubtful() const {
  std::vector<DoubtfulProbe> probes;
  for (std::size_t probe = 0; probe < rays_.size(); ++probe) {
    if (rays_[probe] < kFewestRays) continue;
    const double share = static_cast<double>(contradicting_[probe]) / static_cast<double>(rays_[probe]);
    if (share > kMostContradicting) probes.push_back({probe, share});
  }
  std::stable_sort(probes.begin(), probes.end(),
                   [](const DoubtfulProbe& a, const DoubtfulProbe& b) { return a.share > b.share; });
  return probes;
}

double RayConsistency::close_difference() const {
  if (close_pairs_ < kFewestPairs || !(square_radiance_ > 0)) return 0;
  return std::sqrt(square_difference_ / square_radiance_);
}

}  // namespace lightwell
