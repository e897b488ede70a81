// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "lighting/vector.h"

namespace lightwell {

// CIE 1931 (x, y) of an RGB space's primaries and white. Default: Rec. 709, D65.
struct Chromaticities {
  Eigen::Vector2d red{0.64, 0.33};
  Eigen::Vector2d green{0.30, 0.60};
  Eigen::Vector2d blue{0.15, 0.06};
  Eigen::Vector2d white{0.3127, 0.3290};
};

// Rec. 709 to the digits that programs round it to.
bool is_rec709(const Chromaticities& space);

// Linear RGB of the space to linear Rec. 709, D65: to XYZ (SMPTE RP 177), adapted from its white to D65 by the linear
// Bradford transform (ICC.1:2010, annex E), to Rec. 709. White stays white: (1, 1, 1) to (1, 1, 1).
// none: not finite, a white without luminance, or primaries on one line
std::optional<Eigen::Matrix3d> rec709_from(const Chromaticities& space);

// colour = matrix · colour of every pixel. A value that is not finite stays in its own channel, for the caller to judge,
// and adds nothing to the others; results beyond float's range are clamped to it.
void convert_colours(std::span<Rgb> pixels, const Eigen::Matrix3d& matrix);

}  // namespace lightwell
