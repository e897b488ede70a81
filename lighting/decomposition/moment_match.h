// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "lighting/decomposition/atoms.h"

namespace lightwell {

// Real spherical harmonics of degree 0, 1, 2 and 4 times their Lambertian factors π, 2π/3, π/4, −π/24
// (Ramamoorthi and Hanrahan 2001; degree 3 gives no irradiance): 18 rows, a column a direction.
Eigen::MatrixXd lambertian_moments(const Directions& directions);

// The least relative change of powers (lights × RGB, ≥ 0) that brings their Lambertian moments to `target`
// (18 × RGB): matched softly (a light's power is never changed by more than a factor of 4), so that shaded
// surfaces see the map's own irradiance although the lights were placed for shadows.
void match_moments(const Directions& directions, const Eigen::MatrixXd& target,
                   Eigen::Matrix<double, Eigen::Dynamic, 3>& power);

}  // namespace lightwell
