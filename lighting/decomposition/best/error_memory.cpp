// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/best/error_memory.h"

#include <algorithm>
#include <cmath>

namespace lightwell {

ErrorMemory::ErrorMemory(int lights, int atoms, int stride)
    : error_(atoms + lights + placement_kernel::kLanes) {
  for (auto& row : potential_) row.assign(static_cast<std::size_t>(stride), 0);
}

void ErrorMemory::keep(const Frame& frame) noexcept {
  const auto atoms = static_cast<std::size_t>(frame.atoms.count);
  error_.count = frame.atoms.count;
  std::copy_n(frame.atoms.x.begin(), atoms, error_.x.begin());
  std::copy_n(frame.atoms.y.begin(), atoms, error_.y.begin());
  std::copy_n(frame.atoms.z.begin(), atoms, error_.z.begin());
  std::copy_n(frame.atoms.ground.begin(), atoms, error_.ground.begin());
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t k = 0; k < atoms; ++k) error_.weight[c][k] = -frame.atoms.weight[c][k];
  moments_ = -frame.atom_moments;
  for (int i = 0; i < frame.lights.count(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Rgbd w(frame.power[0][k], frame.power[1][k], frame.power[2][k]);
    error_.add(frame.lights.direction(i), w, 0);
    moments_ += frame.lights.moments(i) * w.matrix().transpose();
  }
  error_.finish();
  for (std::size_t c = 0; c < 3; ++c) {
    frame.powers.potential(frame.power[c], potential_[c]);
    for (std::size_t i = 0; i < static_cast<std::size_t>(frame.lights.count()); ++i)
      potential_[c][i] -= frame.map_potential[c][i];
  }
  total_ = frame.atoms.total;
  scale_ = frame.atoms.scale;
  kept_ = true;
}

void ErrorMemory::scale_to(const Atoms& atoms) noexcept {
  if (!kept_) return;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto channel = static_cast<Eigen::Index>(c);
    const double before = total_[channel], now = atoms.total[channel];
    double factor = before > 0 ? std::min(1.0, now / before) * (scale_ / atoms.scale) : 0;
    if (!std::isfinite(factor)) factor = 0;
    if (factor == 1) continue;
    for (int k = 0; k < error_.padded(); ++k)
      error_.weight[c][static_cast<std::size_t>(k)] *= static_cast<float>(factor);
    for (double& p : potential_[c]) p *= factor;
    moments_.col(channel) *= factor;
  }
}

void ErrorMemory::look_from(const PlacedLights& lights, int i) noexcept {
  if (kept_) lights.potentials(error_, moments_, i, i + 1, potential_);
}

}  // namespace lightwell
