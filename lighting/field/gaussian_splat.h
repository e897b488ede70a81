// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lighting/field/shear_plane.h"

namespace lightwell {

// The kernel of Löw et al. 2009: a Gaussian of fixed support, 3 cells across. They give no width; support ends at 3 σ.
inline constexpr double kSplatSigmaCells = kNearCells / 3;

// Radiance at every pixel as the mean of the rays within the kernel, by its weight; pixels that no ray reaches are
// repaired by pull–push: from the finest half-resolution level that knows anything around them, interpolated.
// Known is where a ray reaches. samples: any number; none leaves the image 0. image is sized to the plane.
// source: Löw et al. 2009, sections 3.2 and 3.3; theirs is three-dimensional, which for parallel rays is the same
// splat, and a repair along the rays as well as across them.
void gaussian_splat(const ShearPlane& plane, std::span<const PlaneSample> samples, PlaneImage& image);

}  // namespace lightwell
