// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/polar_turn.h"

#include <cmath>

namespace lightwell {

void turn_about_zenith(const PolarMap& map, double heading_rad, PolarMap& turned) {
  const auto sectors = static_cast<std::size_t>(map.grid.sectors);
  if (turned.grid != map.grid || turned.channels != map.channels ||
      turned.radiance.size() != map.radiance.size())
    turned = PolarMap::make(map.grid, map.channels);
  const double shift = (heading_rad / (2 * kPi) - std::floor(heading_rad / (2 * kPi))) * map.grid.sectors;
  const auto whole = static_cast<std::size_t>(shift);
  const auto part = static_cast<float>(shift - std::floor(shift));
  for (std::size_t row = 0; row < map.radiance.size(); row += sectors)
    for (std::size_t s = 0; s < sectors; ++s) {
      // What comes to stand at s was `shift` sectors before it.
      const std::size_t near = (s + 2 * sectors - whole) % sectors, far = (near + sectors - 1) % sectors;
      const float here = map.radiance[row + near];
      // Not 0 × NaN: a whole turn leaves its neighbours out.
      turned.radiance[row + s] = part > 0 ? (1 - part) * here + part * map.radiance[row + far] : here;
    }
}

}  // namespace lightwell
