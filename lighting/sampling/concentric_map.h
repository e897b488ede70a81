// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "lighting/vector.h"

namespace lightwell {

// A point of the unit disc: squared radius and angle as a fraction of a turn, both in [0, 1].
// Uniform points of the square become uniform (radius2, turns), because dA = ½ d(r²) dφ.
struct DiscPoint {
  double radius2 = 0;
  double turns = 0;
};

// Unit square to unit disc, area-preserving, continuous, and free of the seam a polar map has: concentric
// squares become concentric circles. source: Shirley and Chiu 1997, "A low distortion map between disk and
// square".
inline DiscPoint disc_from_square(const Vec2d& square) {
  const double a = 2 * square.x() - 1;
  const double b = 2 * square.y() - 1;
  if (a == 0 && b == 0) return {};
  const bool right_or_left = std::abs(a) > std::abs(b);
  const double radius = std::max(std::abs(a), std::abs(b));
  // Eighths of a turn within the sector, then the sector's own axis: +a is 0, +b a quarter, and so on.
  const double eighth = right_or_left ? b / a : -a / b;
  const double axis = right_or_left ? (a > 0 ? 0.0 : 0.5) : (b > 0 ? 0.25 : 0.75);
  double turns = axis + eighth / 8;
  if (turns < 0) turns += 1;
  return {radius * radius, turns};
}

// Exact inverse of disc_from_square.
inline Vec2d square_from_disc(const DiscPoint& disc) {
  const double radius = std::sqrt(disc.radius2);
  const double octants = disc.turns * 8;
  double a = 0;
  double b = 0;
  if (octants < 1 || octants >= 7) {
    a = radius;
    b = radius * (octants < 1 ? octants : octants - 8);
  } else if (octants < 3) {
    b = radius;
    a = -radius * (octants - 2);
  } else if (octants < 5) {
    a = -radius;
    b = -radius * (octants - 4);
  } else {
    b = -radius;
    a = radius * (octants - 6);
  }
  return {(a + 1) / 2, (b + 1) / 2};
}

}  // namespace lightwell
