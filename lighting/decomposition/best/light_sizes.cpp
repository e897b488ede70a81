// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/best/light_sizes.h"

namespace lightwell {
namespace {

constexpr float kPartOfTheNew = 0.2f;  // a frame

}  // namespace

LightSizes::LightSizes(int lights)
    : radius_(static_cast<std::size_t>(lights), -1.0f), is_moved_(static_cast<std::size_t>(lights), 0) {
  for (auto& half : moments_) half.resize(static_cast<std::size_t>(lights));
}

void LightSizes::forget() noexcept {
  std::fill(radius_.begin(), radius_.end(), -1.0f);
  for (auto& half : moments_) std::fill(half.begin(), half.end(), SecondMoment());
}

void LightSizes::follow(const Atoms& atoms, const PlaceSearch& served, const PlacedLights& lights,
                        std::span<const int> moved) noexcept {
  const int middle = PlaceSearch::middle(atoms);
  for (int half = 0; half < 2; ++half)
    if (served.looked_at(half == 0 ? 0 : middle))
      std::fill(moments_[static_cast<std::size_t>(half)].begin(),
                moments_[static_cast<std::size_t>(half)].end(), SecondMoment());
  for (const int light : moved) {
    is_moved_[static_cast<std::size_t>(light)] = 1;
    radius_[static_cast<std::size_t>(light)] = -1;
    for (auto& half : moments_) half[static_cast<std::size_t>(light)] = SecondMoment();
  }
  for (int k = 0; k < atoms.count; ++k) {
    const bool looked_at = served.looked_at(k);
    if (!looked_at && moved.empty()) continue;
    auto [light, distance] = served.served(k);
    bool is_new = false;
    for (const int other : moved) {
      const auto away = static_cast<float>((atoms.direction(k) - lights.direction(other)).norm());
      if (!(away < distance)) continue;
      light = other;
      distance = away;
      is_new = true;
    }
    // What was looked at before is counted already; a light that left leaves its atoms to the next look.
    if (!is_new && (!looked_at || is_moved_[static_cast<std::size_t>(light)] != 0)) continue;
    const auto atom = static_cast<std::size_t>(k);
    moments_[k < middle ? 0 : 1][static_cast<std::size_t>(light)].add(
        static_cast<double>(atoms.luminance[atom]), static_cast<double>(atoms.solid_angle_sr[atom]),
        static_cast<double>(distance));
  }
  for (const int light : moved) is_moved_[static_cast<std::size_t>(light)] = 0;
  for (std::size_t i = 0; i < radius_.size(); ++i) {
    SecondMoment whole = moments_[0][i];
    whole.add(moments_[1][i]);
    if (whole.empty()) continue;
    const float now = whole.disc_radius_rad();
    radius_[i] = radius_[i] < 0 ? now : radius_[i] + kPartOfTheNew * (now - radius_[i]);
  }
}

}  // namespace lightwell
