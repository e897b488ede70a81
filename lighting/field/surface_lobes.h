// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lighting/field/zonal_lobe.h"

namespace lightwell {

// What surfaces make of light, ready for spherical harmonics: zonal lobes by a material's one number and the cosine between
// normal and eye, as tables that are interpolated linearly. Everything is for a normal of +Y and an eye in the plane of x
// and y; directions are those of z ≥ 0 and count for their mirror images too, which changes no lobe about an axis of z = 0.

// Directions that a Phong lobe (n + 2)/2π max(0, R·d)ⁿ max(0, N·d) gathers. exponent: above 0; cosine: N·R, in (0, 1].
std::vector<GatheredDirection> gathered_by_phong(double exponent, double cosine);

// Those that glTF's metallic–roughness gathers: Trowbridge–Reitz distribution, Smith masking, α = roughness².
struct GatheredByRoughness {
  std::vector<GatheredDirection> base;  // of Schlick's Fresnel term what is times F0: 1 − (1 − v·h)⁵
  std::vector<GatheredDirection> edge;  // the rest, (1 − v·h)⁵
};
GatheredByRoughness gathered_by_roughness(double roughness, double cosine);
// What the diffuse part under it gathers, times 1 − F0: (1 − (1 − v·h)⁵) max(0, N·d) / π.
std::vector<GatheredDirection> gathered_below(double cosine);

// The mirrored eye for a normal of +Y.
inline Vec3d mirrored_eye(double cosine) {
  return {std::sqrt(std::max(0.0, 1 - cosine * cosine)), cosine, 0};
}

// A table's entry: a lobe as wide as its degree holds (widest_needed) or as it is, whichever is wider.
inline constexpr double kMostRinging = 0.02;
struct SurfaceLobe {
  ZonalLobe lobe;                                    // Phong's, or base
  std::array<double, kMostFieldDegree + 1> edge{};   // about the same axis; 0 for Phong
  std::array<double, kMostFieldDegree + 1> below{};  // about the normal; 0 for Phong
};
SurfaceLobe phong_surface(double exponent, double cosine, int degree);
SurfaceLobe rough_surface(double roughness, double cosine, int degree);

// kLobeSteps × kLobeSteps entries: columns by the material's number, rows by the cosine, each from 0 to 1. A Phong exponent
// n stands at n / (n + kExponentMiddle).
inline constexpr int kLobeSteps = 48;
inline constexpr double kExponentMiddle = 6;
std::vector<SurfaceLobe> phong_table(int degree);
std::vector<SurfaceLobe> roughness_table(int degree);
// Linear between the four entries around it, as a texture does. place: of the material's number, 0 to 1.
SurfaceLobe look_up(std::span<const SurfaceLobe> table, double place, double cosine);

}  // namespace lightwell
