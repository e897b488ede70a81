// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calibration/photometric/photograph.h"
#include "lighting/response.h"
#include "lighting/result.h"

// The response of an ordinary camera from photographs of one scene at several exposures.
namespace lightwell::calibration {

inline constexpr std::size_t kMostPhotographs = 30;  // every one is compared with every other
// bad_input: too few or too many; to be asked before they are read.
Status check_number_of_photographs(std::size_t count);

enum class BracketSolver { debevec, robertson };

// How well the response from other exposures foretells a photograph that was not used.
struct Prediction {
  std::string file;
  double exposure_s = 0;
  std::optional<double>
      median_error;  // relative, of the unclipped pixels of all three channels; none: there are none
  std::size_t pixels = 0;
};

struct BracketFit {
  Response response;  // piecewise linear through the 8 bit codes, of green
  std::vector<Prediction> predictions;
  // Over the pixels and channels of all of them, by the curve of green; none: nothing was foretold, as with three
  // photographs, whose middle one is needed by the fit.
  std::optional<double> median_error;
  std::array<std::optional<double>, 3> channel_median_error;  // of red, green, blue alone
  bool absolute = false;  // scaled by aperture and ISO (ISO 2720, K = 12.5); else 1 at code 118
  double scale = 1;       // by which a measurement then corrected it
  std::array<double, 3> channel_spread = {0, 0,
                                          0};  // median relative difference of each colour's curve from green
};

// OpenCV's Debevec–Malik or Robertson solver, given not single pixels but medians: what the pixels of one code in one
// photograph have in the others. The curve is made to increase (pooling adjacent violators). The reported error is that
// of exposures which were kept out of a fit and foretold by it, all three channels by the curve of green as
// merge_brackets has them; the response itself is of all. Both are of the squares' mean codes, and of those squares alone
// that are even in the photographs compared: the mean code of others is not the code of their mean light. With more than
// some two stops between neighbours the pictures overlap too little to tell the curve. Robertson's does not smooth: with even
// steps it keeps, of its straight start, what repeats from step to step.
// bad_input: fewer than 3 photographs or exposures, more than kMostPhotographs, different sizes,
// apertures or ISO, codes that do not follow the exposures.
Result<BracketFit> fit_brackets(std::vector<Photograph> photographs, BracketSolver solver);

// Multiplies all luminances by what a meter says they are too small by. bad_input: then they are
// out of the range that responses have; fit is scaled all the same.
Status scale_luminance(BracketFit& fit, double scale);

// A line for a person where red's or blue's curve is not green's, which the response is; else empty.
std::string channel_warning(const BracketFit& fit);

nlohmann::ordered_json report_to_json(const BracketFit& fit);
std::string bracket_response_file(const BracketFit& fit);

}  // namespace lightwell::calibration
