// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "lighting/decomposition/placement_kernel/kernel.h"
#include "lighting/vector.h"

// What it costs to show light from one direction as light from others. For a map μ and lights ν over the sphere the cost
// is the quadratic form ½ ∫∫ k(a, b) d(μ − ν)(a) d(μ − ν)(b) of a positive definite kernel with two parts:
//
//   k(a, b) = (plain + ground · s(a) s(b)) · (3 − |a − b|)  +  irradiance · k_E(a · b)
//
// Shadows: the form with −|a − b| is the energy distance (Székely and Rizzo 2013). It integrates the squared difference
// of the light in every half-space, so it sees the edge of any shadow without bins. The ground's share s(y) = min(1, |y|
// / ½) knows that on a horizontal surface low light counts little: its long shadow leaves what is near the object.
// Irradiance: k_E(a · b) = ∫ max(0, n·a) max(0, n·b) dn over all normals, by its Legendre series of degrees 0, 1, 2, 4
// (99.9 % of it), scaled to 1 at a = b: the squared error of irradiance over all normals is then part of what is
// minimised.
// Distances are softened, √(r² + (0.1°)²): nearer places are one.
namespace lightwell {

inline constexpr double kPlainShare = 0.2;
inline constexpr double kGroundShare = 0.8;
inline constexpr double kSoftening_rad = 0.1 * kPi / 180;
inline constexpr double kIrradianceWeight = 8;
inline constexpr double kRidge = 1e-8;  // added where a = b: two lights in one place share their power

using MomentVector = Eigen::Matrix<double, placement_kernel::kMoments, 1>;
using MomentMatrix = Eigen::Matrix<double, placement_kernel::kMoments, 3, Eigen::RowMajor>;

placement_kernel::Shares kernel_shares();
double ground_share(double y);
double ground_share_slope(double y);

// A_l · Y_lm(d) of degrees 0, 1, 2, 4, orders ascending: irradiance at n is Σ moments(d) · Y(n).
// source: Ramamoorthi and Hanrahan 2001
MomentVector lambertian_moments(const Vec3d& d);
// irradiance · k_E = this · moments(a) · moments(b)
double moment_weight();

// k(a, b), without the ridge.
double error_kernel(const Vec3d& a, const Vec3d& b);
// The gradient in a of irradiance · k_E(a · b) summed over light of the given moments.
Vec3d moment_gradient(const Vec3d& a, const MomentVector& of_light);

}  // namespace lightwell
