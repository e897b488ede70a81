// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "calibration/lens/lens_adjustment.h"

namespace lightwell::calibration {

// How much of the model the data support.
struct LensSelection {
  LensFreedom freedom;
  // √mean(du² + dv²) of views that were not fitted to, their poses alone.
  double held_out_rms_px = 0;
};

// The board's shape where the views ask for it: where the corrected Akaike criterion is better by more than 10 (no
// support is left for the square board; Burnham and Anderson 2002, section 2.6). Nothing for a target that is not flat.
// views: with the points of the square board; square: that board.
std::optional<TargetShape> supported_shape(const Lens& lens, const std::vector<PosedView>& views,
                                           const TargetShape& square);

// In words, for those who read lens.json.
inline constexpr const char* kCoefficientsRule =
    "four, and fewer as long as that lowers the error on views held out by more than 1 %; of points exact to "
    "0.0001 px the "
    "fewest that explain them";

// Aspect by the corrected Akaike criterion (Hurvich and Tsai 1989). Coefficients by cross-validation in at most
// five parts by views: dropped from the highest as long as the held-out error falls by more than 1 %. Not the fewest that
// a criterion of evidence asks for: docs/decisions/026-lens-coefficients.md. Computed points, which have no noise, have no
// more than the fewest that explain them (0 to 4).
// lens, views: solved with everything free.
LensSelection select_freedom(const Lens& lens, const std::vector<PosedView>& views);

// √mean(du² + dv²) in pixels over views that the lens was not fitted to, their poses alone: in at most five parts by
// views, each part held out once. Infinite where the views that remain determine no lens.
double held_out_rms_px(const Lens& lens, const std::vector<PosedView>& views, const LensFreedom& freedom);

}  // namespace lightwell::calibration
