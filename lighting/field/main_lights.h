// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lighting/field/light_field.h"

namespace lightwell {

// The part of a field that comes from a few directions, the same everywhere, with its own illuminance at every grid point: a
// spot's edge stays where it is. What such a light gives of a field of a degree is illuminance · Y_lm(direction).
struct MainLights {
  std::vector<Vec3d> directions;  // unit, from the field toward the light
  // Lux on a surface that faces the light, at least 0: [light][z][R, G, B][y][x].
  std::vector<float> illuminance;

  // One channel of one light in slab z: [y][x].
  [[nodiscard]] const float* plane(int light, int z, int channel, const FieldGrid& grid) const;
};

inline constexpr int kMostMainLights = 8;

// Up to `count` directions, found one after the other: each is the one in which the points' luminance, less what an ambient
// term and the lights so far make of it, is largest in squares over the points; then all are moved to where they explain
// most. None is taken that would have less than kLeastMainLight of the light, so that an even field has none.
// The illuminances are the non-negative least squares of each point's harmonics by the lights and an ambient term.
// low, high: points outside this box are not asked where the lights are, unless none is inside.
// source: simultaneous orthogonal matching pursuit, Tropp, Gilbert and Strauss 2006, with non-negative powers
inline constexpr double kLeastMainLight = 0.02;
MainLights find_main_lights(const LightField& field, int count, const Vec3d& low, const Vec3d& high);

}  // namespace lightwell
