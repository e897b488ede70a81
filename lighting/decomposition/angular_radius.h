// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lighting/light_set.h"
#include "lighting/polar_map.h"

namespace lightwell {

// How wide a light is: the radius of an even disc around its direction whose second moment is that of its part of the
// map, each bin weighted by its illuminance times its radiance. So what is bright counts: a sun stays small whatever sky
// is nearest to it, a piece of window or sky is as wide as it is.
class SecondMoment {
 public:
  // luminance: of its illuminance; distance: chord from the light to the part's middle
  void add(double luminance, double solid_angle_sr, double distance) noexcept;
  [[nodiscard]] bool empty() const { return !(weight_ > 0); }
  // At most kLargestAngularRadius; 0 while empty
  [[nodiscard]] float disc_radius_rad() const noexcept;

 private:
  double weight_ = 0, moment_ = 0;
};

// Beyond it a disc has no middle worth the name.
inline constexpr float kLargestAngularRadius = 1.0f;

// From the bins that are nearest to each light. map: radiance finite and ≥ 0
void set_angular_radii(const PolarMap& map, std::span<DirectionalLight> lights);

}  // namespace lightwell
