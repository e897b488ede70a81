// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lighting/vector.h"

namespace lightwell::pictures {

// Row 0 at the top.
struct LinearPicture {
  int width = 0;
  int height = 0;
  std::vector<Rgb> pixels;  // linear Rec. 709 of a display, [0, 1]
};

// How differently two pictures look where one is shown after the other in the same place, each pixel 0 (alike) to 1.
// pixels_per_degree: of the eye's field; 67 is a 0.7 m wide display of 3840 pixels seen from 0.7 m
// both of one size
// source: Andersson et al. 2020, FLIP: A Difference Evaluator for Alternating Images (LDR)
std::vector<float> flip(const LinearPicture& reference, const LinearPicture& picture,
                        double pixels_per_degree = 67.0206);

}  // namespace lightwell::pictures
