// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/best/light_sizes.h"

#include <algorithm>

namespace lightwell {
namespace {

constexpr float kPartOfTheNew = 0.2f;  // a frame

}  // namespace

LightSizes::LightSizes(int lights)
    : radius_(static_cast<std::size_t>(lights), -1.0f), moments_(static_cast<std::size_t>(lights)) {}

void LightSizes::forget() noexcept {
  std::fill(radius_.begin(), radius_.end(), -1.0f);
}

void LightSizes::forget(int light) noexcept {
  radius_[static_cast<std::size_t>(light)] = -1;
}

void LightSizes::follow(const Atoms& atoms, const PlaceSearch& served) noexcept {
  std::fill(moments_.begin(), moments_.end(), SecondMoment());
  served.for_each_atom([&](std::size_t atom, std::size_t light, float distance) {
    moments_[light].add(static_cast<double>(atoms.luminance[atom]),
                        static_cast<double>(atoms.solid_angle_sr[atom]), static_cast<double>(distance));
  });
  for (std::size_t i = 0; i < radius_.size(); ++i) {
    if (moments_[i].empty()) {
      radius_[i] = std::max(radius_[i], 0.0f);
      continue;
    }
    const float now = moments_[i].disc_radius_rad();
    radius_[i] = radius_[i] < 0 ? now : radius_[i] + kPartOfTheNew * (now - radius_[i]);
  }
}

}  // namespace lightwell
