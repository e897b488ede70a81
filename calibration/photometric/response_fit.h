// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "calibration/photometric/patches.h"
#include "calibration/photometric/response_curve.h"
#include "lighting/response.h"

namespace lightwell::calibration {

struct ResponseFitOptions {
  std::optional<Curve> curve;        // none: the simplest that the patches support
  double luminance_error = 0.01;     // relative standard deviation of the patches' luminances
  double code_sigma = 0.5;           // codes; of patches that do not say
  int bits = 0;                      // 0: the fewest of 8, 10, 12, 14, 16 that hold every code
  double clip_code = 0;              // 0: the largest code
  double reference_exposure_us = 0;  // 0: that of the first patch that says one, else 10000
};

// What neither the options nor the patches said, though codes mean nothing without it.
struct Assumption {
  std::string key;  // of response.json
  double value = 0;
  std::string reason;  // "the fewest that hold every code"
  std::string option;  // that states it: "--bits"
};

// One form of curve, tried on the patches.
struct CurveScore {
  Curve curve = Curve::log;
  int segments = 0;  // pwl
  int parameters = 0;
  double aicc = 0;
  double chi2 = 0;      // of the patches used, in the stated noise
  std::string refused;  // why it cannot be had; empty: it can
};

struct PatchResidual {
  Patch patch;
  bool rejected = false;       // left out of the fit: it contradicts the others
  double luminance_cd_m2 = 0;  // that the fitted response gives for the patch's code
  double relative_error = 0;   // luminance_cd_m2 / the patch's − 1; NaN: the patch is dark
  double stops = 0;            // log2 of their ratio; NaN: one of them is dark
  double code_residual = 0;    // code − that of the fitted response
  std::array<double, 2> interval = {0,
                                    0};  // 95 %, for the true luminance and a reading of it as good as stated
  bool inside = false;                   // the patch's luminance lies in the interval
  // Of a patch that is fitted: the fit's variance at it over its own, up to 1. Near 1 the curve goes through it whatever
  // it says: an error of its reading is seen by no residual. NaN in darkness, and of check patches.
  double leverage = std::numeric_limits<double>::quiet_NaN();
};

// The fitted response with what is known of its error.
//
// Every patch has a standard deviation in codes, s² = code_sigma² + (slope · luminance · luminance_error)². The weights
// are fixed by the slope of the previous round. The covariance is (JᵀWJ)⁻¹ times a scale that weighs the stated noise,
// counted as four residuals, against the χ² that came out: (4 + χ²)/(4 + n − k); intervals are Student's with as many
// degrees of freedom. So a few patches that happen to agree do not make the claim narrower than the meter is good for,
// and patches noisier than stated widen it.
struct ResponseFit {
  Response response;
  Curve curve = Curve::log;
  bool curve_given = false;    // not chosen among all
  Eigen::MatrixXd covariance;  // in the order of parameter_names(response.model)
  double noise_scale = 1;      // square root of the scale above
  double degrees = 0;
  double t95 = 0;              // Student's, two-sided
  double luminance_error = 0;  // as stated
  std::vector<Assumption> assumed;
  std::vector<PatchResidual> fit, check;
  std::vector<CurveScore> scores;
  std::optional<std::array<double, 2>> usable_codes;  // between the patches, where error_95 < kUsableError

  // Of the luminance that the response gives for a code, from the parameters alone, relative: one standard deviation,
  // and the half-width of the 95 % interval.
  [[nodiscard]] double relative_sigma(double code) const;
  [[nodiscard]] double relative_error_95(double code) const { return t95 * relative_sigma(code); }
};
inline constexpr double kUsableError = 0.05;
// Of leverage, from where on the curve rests on the patch alone.
inline constexpr double kAloneLeverage = 0.9;
// Difference of AICc that leaves the other no support (Burnham and Anderson 2002).
inline constexpr double kStrongAicc = 10;

// The code from which fit_response takes codes of this set for clipped.
double clip_code_of(const PatchSet& patches, const ResponseFitOptions& options);

// Robust against one bad patch: where leaving one out makes the others agree, by more than chance allows, it is left out
// and marked. Curves are compared by Akaike's criterion, −2 ln likelihood with the noise as stated + 2k, with the
// correction for few samples of Hurvich and Tsai (1989). That one is derived for noise estimated from the residuals, and
// is too much for noise that is known; it is kept because the stated noise is a guess too, and few patches should not
// buy a curve with many parameters. The first of linear, log, linlog and pwl wins that no other is better than by 10, for
// where patches do not tell log from linlog the least is a toss; the report names the runner-up.
// What is not stated is assumed, on the safe side, and said: bits are the fewest that hold every code and clip_code the
// largest code of these, because a clipped code taken for light is wrong without a sign, light taken for clipped is
// counted, and frames of more bits are refused.
// bad_input: see ordered_and_checked; no curve rises; the chosen one has too many parameters for the patches.
Result<ResponseFit> fit_response(const PatchSet& patches, const ResponseFitOptions& options);

}  // namespace lightwell::calibration
