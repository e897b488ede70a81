// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "calibration/photometric/vignetting_fit.h"
#include "lighting/frame_format.h"
#include "lighting/response.h"

// Lamps, reflections, dust: places where a scene is not even, which no fixed pattern of a sensor looks like.
namespace lightwell::calibration {

// Vignetting, and the samples that remain once such places are left out.
struct CleanFit {
  VignettingFit fit;
  double tilt_before = 0;  // of the scene, with nothing masked
  std::vector<EvenSample> samples;
  std::vector<std::size_t> masked;      // pixels, ascending, left out of one take or more
  std::vector<std::size_t> masked_in;   // their number in each take
  std::vector<std::size_t> samples_in;  // of each take, before
};

// Fits, masks and fits again without what was masked, until that stays the same (three times at the most).
// Masked is where the residuals in a square of five by five pixels lie on one side by more than four times the spread of
// the pixels' own pattern (robust; columns and rows, by which patterns go, taken out), each residual counted as six times at
// the most, so that a hot pixel or a short run of them is no place; around it, all that is still beyond one time; and two
// pixels more. In a mosaic the squares are of each colour, too: lamps have colours.
CleanFit fit_without_lamps_and_dust(const std::vector<EvenSample>& samples, const Response& response,
                                    const FrameFormat& format, int levels, int takes);

// Offsets of masked pixels that nothing else told: the median of their column's, for patterns go by columns; 0 where the
// column has fewer than eight. told: [pixel] whether it has an offset.
void fill_masked(const std::vector<std::size_t>& masked, const std::vector<char>& told, int width,
                 std::vector<float>& offset_codes);

}  // namespace lightwell::calibration
