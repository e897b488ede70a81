// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace lightwell {

// How wide a light is: the radius of an even disc around its direction whose second moment is that of what it stands for,
// each part weighted by its illuminance times its radiance. So what is bright counts: a sun stays small whatever sky is
// nearest to it, a piece of window or sky is as wide as it is.
class SecondMoment {
 public:
  // luminance: of the part's illuminance; distance: chord from the light to the part's middle
  void add(double luminance, double solid_angle_sr, double distance) noexcept;
  void add(const SecondMoment& other) noexcept;
  [[nodiscard]] bool empty() const { return !(weight_ > 0); }
  // At most kLargestAngularRadius; 0 while empty
  [[nodiscard]] float disc_radius_rad() const noexcept;

 private:
  double weight_ = 0, moment_ = 0;
};

// Beyond it a disc has no middle worth the name.
inline constexpr float kLargestAngularRadius = 1.0f;

}  // namespace lightwell
