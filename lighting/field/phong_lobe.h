// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lighting/harmonics.h"

namespace lightwell {

// The Phong lobe max(0, r·d)^s about a unit direction r as spherical harmonics: turned zonal harmonics,
// ρ_lm = 2π I_l Y_lm(r), I_l = ∫₀¹ t^s P_l(t) dt.
// source: Löw et al. 2009, section 4; Ramamoorthi and Hanrahan 2004 for the turning; I_l by its recurrence,
// I_l = I_{l−2} (s − l + 2) / (s + l + 1)

// I_l for l = 0 … degree ≤ kMostDegree; exponent: 0 or more.
void phong_moments(double exponent, int degree, double* moments) noexcept;
// ρ_lm, [harmonic_count(degree)].
void phong_lobe(const Vec3d& axis, double exponent, int degree, double* coefficients) noexcept;
// What a degree leaves out of the lobe: ‖lobe − its harmonics‖ / ‖lobe‖ over the sphere. 14 % at degree 4, exponent 6.
double phong_truncation(double exponent, int degree) noexcept;

}  // namespace lightwell
