// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "lighting/field/light_field.h"

namespace lightwell {

// How a surface gathers the light around it, as directions and what each counts: reflectance times cosine times solid angle.
struct GatheredDirection {
  Vec3d direction;  // unit
  double weight = 0;
};

// The same as one zonal lobe Σ_l z_l (2l + 1)/4π P_l(axis·d): what it gathers of spherical harmonics L_lm is
// Σ_l z_l Σ_m L_lm Y_lm(axis), with no product of harmonics and no rotation of a whole band.
struct ZonalLobe {
  double toward_normal = 0;  // axis ∝ (1 − t) · mirrored + t · normal
  std::array<double, kMostFieldDegree + 1> bands{};
  [[nodiscard]] Vec3d axis(const Vec3d& normal, const Vec3d& mirrored) const {
    return ((1 - toward_normal) * mirrored + toward_normal * normal).normalized();
  }
};

// The lobe that differs least from what is gathered, among those whose axis lies in the plane of normal and mirrored eye.
// With z_l = ∫ K(d) P_l(axis·d) that difference is least for an axis; the axis is that of the most Σ (2l + 1)/4π z_l².
ZonalLobe best_zonal_lobe(std::span<const GatheredDirection> gathered, const Vec3d& normal,
                          const Vec3d& mirrored, int degree);
// The bands of the best lobe about a given axis.
ZonalLobe zonal_lobe_about(std::span<const GatheredDirection> gathered, const Vec3d& normal,
                           const Vec3d& mirrored, double toward_normal, int degree);

// A lobe that is narrower than its degree can hold rings: around it are negative rings, which a bright lamp makes visible. A
// Gaussian on the sphere, e^(−l(l+1)τ), of this τ makes even a mirror's as wide as the degree holds: no value is below
// −most_negative times that on the axis. source: the heat kernel as a window; Sloan 2008, "Stupid spherical harmonics
// tricks", windows the light, which here stays as it is.
double widest_needed(int degree, double most_negative);
// Turns a lobe into one that is wider by that Gaussian.
void widen(ZonalLobe& lobe, int degree, double tau);

}  // namespace lightwell
