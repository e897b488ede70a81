// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lighting/decomposition/best/placed_lights.h"

namespace lightwell {

// Where a light may be missing: of every light and quadrant around it the atom that is served worst, and of these the
// worst. Also knows each atom's nearest light. Allocates nothing after construction.
class PlaceSearch {
 public:
  PlaceSearch(int lights, int atoms);
  static int most_places(int lights);

  // The nearest light of every atom; with many lights of half of the atoms one frame, of the others the next, where
  // all is false.
  void look(const Atoms& atoms, const PlacedLights& lights, bool all) noexcept;
  // Places from what was looked at.
  void find(const Atoms& atoms, const PlacedLights& lights) noexcept;

  [[nodiscard]] std::span<const Vec3d> places() const { return places_; }
  [[nodiscard]] const Atoms& place_points() const { return place_points_; }

  // Of an atom, as it was last looked at: its light, and their distance (chord).
  struct Served {
    int light;
    float distance;
  };
  [[nodiscard]] Served served(int atom) const {
    const auto k = static_cast<std::size_t>(atom);
    return {nearest_[k], distance_[k]};
  }
  // With many lights the atoms before this one are looked at in one frame, the others in the next.
  [[nodiscard]] static int middle(const Atoms& atoms);
  [[nodiscard]] bool looked_at(int atom) const { return atom >= begin_ && atom < end_; }

  // What the lights leave to be shown wrongly, in luminance: Σ atom · power of its light · their distance, over the
  // atoms that were looked at. power: luminance
  [[nodiscard]] double cell_cost(const Atoms& atoms, std::span<const double> power) const noexcept;

 private:
  std::vector<int> nearest_;     // light of an atom
  std::vector<float> distance_;  // to it
  int begin_ = 0, end_ = 0;      // atoms that were looked at
  bool second_half_ = false;     // is next
  std::vector<float> quadrant_score_;
  std::vector<int> quadrant_atom_, order_;
  std::vector<Vec3d> places_;
  Atoms place_points_;
};

}  // namespace lightwell
