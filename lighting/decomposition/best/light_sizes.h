// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "lighting/decomposition/best/place_search.h"
#include "lighting/second_moment.h"

namespace lightwell {

// The lights' angular radii from frame to frame, from the atoms that are nearest to each. They follow slowly, so that a
// shadow's edge neither pops nor flickers where atoms change sides; a light at a new place has its size there at once.
// Allocates nothing after construction.
class LightSizes {
 public:
  explicit LightSizes(int lights);
  void forget() noexcept;
  // served: what has looked at these atoms; moved: lights that came to other places since
  void follow(const Atoms& atoms, const PlaceSearch& served, const PlacedLights& lights,
              std::span<const int> moved) noexcept;
  [[nodiscard]] float radius_rad(int light) const {
    return std::max(radius_[static_cast<std::size_t>(light)], 0.0f);
  }

 private:
  std::vector<float> radius_;   // of a light; negative: not known
  std::vector<char> is_moved_;  // [lights]
  std::array<std::vector<SecondMoment>, 2>
      moments_;  // of the atoms before PlaceSearch::middle, and of the others
};

}  // namespace lightwell
