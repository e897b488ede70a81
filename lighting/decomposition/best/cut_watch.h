// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lighting/decomposition/best/map_in_parts.h"
#include "lighting/decomposition/best/place_search.h"
#include "lighting/decomposition/light_powers.h"

namespace lightwell {

// Tells where the map has become another one (a cut), and whether lights that were found anew then show it so much better
// that they are worth a pop. Exchange finds its way from the lights of any map to those of any other, but slowly where lights
// are many, and not at all where they are so few that each is worth much.
class CutWatch {
 public:
  // Lights that serve with powers of least cost, in luminance.
  struct Serving {
    const PlaceSearch& search;             // has looked at the atoms' nearest lights
    const std::vector<double>& potential;  // the map's, a light
    const std::vector<double>& power;
  };

  CutWatch(int lights, int atoms);

  // Lights were placed with no regard to what was before.
  void placed(const MapInParts& map) noexcept;
  // PlaceSearch::cell_cost of a frame as it is shown.
  void shown(double cell_cost) noexcept;

  // Before exchange, and after it, where it was so before: true where the map may be another one.
  [[nodiscard]] bool may_be_cut(const MapInParts& map, const Serving& now) const;
  [[nodiscard]] bool is_still_cut(const MapInParts& map, const Serving& now) const;

  // The two halves of a trial: what serves, and then whether other places are worth it; where they are not, none are tried
  // until the map has changed again. Both allocate.
  void weigh(const MapInParts& map, const Serving& now);
  [[nodiscard]] bool is_worth_placing(const std::vector<Vec3d>& found, const MapInParts& map,
                                      const Serving& now);

 private:
  [[nodiscard]] bool looks_cut(const MapInParts& map, const Serving& now, double times) const;
  [[nodiscard]] double change_of_moments(const MapInParts& map) const;
  [[nodiscard]] double own_of_atoms(const MapInParts& map);
  [[nodiscard]] double left_wrong(const MapInParts& map, const Serving& lights) const;
  [[nodiscard]] double left_wrong_at(const std::vector<Vec3d>& places, const MapInParts& map,
                                     std::size_t row) const;

  int count_;
  int atoms_;
  double cost_to_double_ = 0;  // of the cells
  MomentVector placed_moments_ = MomentVector::Zero();
  std::vector<double> at_atoms_;
  // Of the trial.
  double own_ = 0;
  double cost_ = 0;
};

}  // namespace lightwell
