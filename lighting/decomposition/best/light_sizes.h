// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lighting/decomposition/angular_radius.h"
#include "lighting/decomposition/best/place_search.h"

namespace lightwell {

// The lights' angular radii from frame to frame, from the atoms that are nearest to each. They follow slowly, so that a
// shadow's edge neither pops nor flickers where atoms change sides. Allocates nothing after construction.
class LightSizes {
 public:
  explicit LightSizes(int lights);
  void forget() noexcept;           // all
  void forget(int light) noexcept;  // it stands at another place
  // served: has looked at these atoms and lights
  void follow(const Atoms& atoms, const PlaceSearch& served) noexcept;
  [[nodiscard]] float radius_rad(int light) const { return radius_[static_cast<std::size_t>(light)]; }

 private:
  std::vector<float> radius_;  // of a light; negative: not known
  std::vector<SecondMoment> moments_;
};

}  // namespace lightwell
