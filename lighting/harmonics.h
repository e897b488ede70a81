// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "lighting/vector.h"

// Real spherical harmonics: orthonormal over the sphere, without Condon–Shortley sign, polar axis +Y, azimuth λ from +Z
// toward +X. Y_lm stands at l(l + 1) + m: N P_l^|m|(cos θ) times √2 cos mλ for m > 0, 1 for m = 0, √2 sin |m|λ for m < 0.
namespace lightwell {

constexpr int harmonic_count(int degree) {
  return (degree + 1) * (degree + 1);
}
constexpr int harmonic_index(int l, int m) {
  return l * (l + 1) + m;
}

// Y_lm of a unit direction to a degree ≤ kMostDegree, [harmonic_count(degree)].
inline constexpr int kMostDegree = 10;
void harmonics(const Vec3d& direction, int degree, double* values) noexcept;
// Their derivatives by steps from the unit direction along two vectors that stand across it.
void harmonic_slopes(const Vec3d& direction, const std::array<Vec3d, 2>& along, int degree,
                     const std::array<double*, 2>& slopes) noexcept;

// What of a band of radiance remains in irradiance: E_lm = A_l L_lm. 0 for odd l above 1.
// source: Ramamoorthi, Hanrahan 2001, "An efficient representation for irradiance environment maps", eq. 8
double irradiance_factor(int l) noexcept;

}  // namespace lightwell
