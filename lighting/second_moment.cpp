// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/second_moment.h"

#include <algorithm>
#include <cmath>

#include "lighting/vector.h"

namespace lightwell {

void SecondMoment::add(double luminance, double solid_angle_sr, double distance) noexcept {
  if (!(luminance > 0 && solid_angle_sr > 0)) return;
  const double weight = luminance * (luminance / solid_angle_sr);
  // The part itself is wide: a disc of solid angle Ω has Ω/2π around its middle.
  weight_ += weight;
  moment_ += weight * (distance * distance + solid_angle_sr / (2 * kPi));
}

void SecondMoment::add(const SecondMoment& other) noexcept {
  weight_ += other.weight_;
  moment_ += other.moment_;
}

float SecondMoment::disc_radius_rad() const noexcept {
  if (empty()) return 0;
  return std::min(static_cast<float>(std::sqrt(2 * moment_ / weight_)), kLargestAngularRadius);
}

}  // namespace lightwell
