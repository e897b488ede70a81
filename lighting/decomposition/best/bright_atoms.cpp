// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/best/bright_atoms.h"

namespace lightwell {
namespace {

constexpr float kBrightShare = 0.01f;

}  // namespace

BrightAtoms::BrightAtoms() {
  all_.reserve(4 * (static_cast<std::size_t>(1 / kBrightShare) + 1));  // of luminance and of each channel
}

void BrightAtoms::take(Atoms& atoms) noexcept {
  all_.clear();
  std::array<float, 3> least{};  // of a channel's own light
  for (std::size_t c = 0; c < 3; ++c)
    least[c] = kBrightShare * static_cast<float>(atoms.total[static_cast<Eigen::Index>(c)] / atoms.scale);
  for (int k = 0; k < atoms.count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    bool bright = atoms.luminance[i] > kBrightShare;
    for (std::size_t c = 0; c < 3; ++c) bright = bright || (least[c] > 0 && atoms.weight[c][i] > least[c]);
    if (!bright || all_.size() == all_.capacity()) continue;
    all_.push_back({atoms.direction(k), atoms.weight_of(k), k});
    for (auto& plane : atoms.weight) plane[i] = 0;
  }
}

void BrightAtoms::give_back(Atoms& atoms) const noexcept {
  for (const Bright& b : all_)
    for (std::size_t c = 0; c < 3; ++c)
      atoms.weight[c][static_cast<std::size_t>(b.atom)] =
          static_cast<float>(b.weight[static_cast<Eigen::Index>(c)]);
}

Rgbd BrightAtoms::potential(const Vec3d& at) const noexcept {
  Rgbd sum = Rgbd::Zero();
  for (const Bright& b : all_) sum += error_kernel(at, b.direction) * b.weight;
  return sum;
}

void BrightAtoms::add_moments(MomentMatrix& moments) const noexcept {
  for (const Bright& b : all_) moments += lambertian_moments(b.direction) * b.weight.matrix().transpose();
}

}  // namespace lightwell
