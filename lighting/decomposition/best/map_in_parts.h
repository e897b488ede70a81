// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lighting/decomposition/best/bright_atoms.h"
#include "lighting/decomposition/best/placed_lights.h"

namespace lightwell {

// A map while its bright atoms are taken out: its other atoms with their moments, and the bright ones.
struct MapInParts {
  const Atoms& atoms;
  const MomentMatrix& atom_moments;
  const BrightAtoms& bright;

  // What all of the map is worth at lights first … last − 1, as PlacedLights::potentials.
  void potentials(const PlacedLights& at, int first, int last, ChannelRows& to) const noexcept;
  [[nodiscard]] MomentMatrix moments() const noexcept;
  [[nodiscard]] MomentVector luminance_moments() const noexcept;
};

// The first n values.
void to_luminance(const ChannelRows& rgb, std::vector<double>& out, int n) noexcept;

}  // namespace lightwell
