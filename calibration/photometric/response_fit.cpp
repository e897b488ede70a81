// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/response_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/photometric/curve_trial.h"
#include "calibration/photometric/response_error.h"

namespace lightwell::calibration {
namespace {

int fewest_bits(const PatchSet& set, double clip_code) {
  double largest = std::max(clip_code, set.largest_code);
  for (const auto* patches : {&set.fit, &set.check})
    for (const Patch& p : *patches) largest = std::max(largest, p.code);
  for (const int bits : {8, 10, 12, 14})
    if (largest < std::ldexp(1.0, bits)) return bits;
  return 16;
}

constexpr double kUsualExposure_us = 10000;

double first_exposure(const PatchSet& set) {
  for (const auto* patches : {&set.fit, &set.check})
    if (!patches->empty() && patches->front().exposure_us > 0) return patches->front().exposure_us;
  return 0;
}

// Bits, clip code and exposure: as stated, else assumed and noted.
void set_scale(ResponseFit& fit, const PatchSet& patches, const ResponseFitOptions& options) {
  const auto assume = [&](const char* key, double value, const char* reason, const char* option) {
    fit.assumed.push_back({key, value, reason, option});
    return value;
  };
  fit.response.bits = options.bits > 0 ? options.bits : patches.bits;
  if (fit.response.bits == 0)
    fit.response.bits = static_cast<int>(
        assume("bits", fewest_bits(patches, options.clip_code), "the fewest that hold every code", "--bits"));
  const double top = std::ldexp(1.0, fit.response.bits) - 1;
  if (options.clip_code > 0)
    fit.response.clip_code = options.clip_code;
  else if (patches.still_at_code > 0 && patches.still_at_code < top)
    fit.response.clip_code = assume("clip_code", patches.still_at_code,
                                    "as pixels stand still there and the others do not", "--clip-code");
  else
    fit.response.clip_code = assume("clip_code", top, "the largest code of these bits", "--clip-code");
  fit.response.reference_exposure_us = options.reference_exposure_us;
  if (!(options.reference_exposure_us > 0)) fit.response.reference_exposure_us = first_exposure(patches);
  if (!(fit.response.reference_exposure_us > 0))
    fit.response.reference_exposure_us =
        assume("reference_exposure_us", kUsualExposure_us, "a usual one", "--exposure-us");
}

// Codes that mean light: above that of darkness.
double black_code(const Response& response) {
  const double dark = model_code(response.model, 0);
  return std::isfinite(dark) && dark >= 0 ? std::floor(dark) + 1 : 0;
}

}  // namespace

double clip_code_of(const PatchSet& patches, const ResponseFitOptions& options) {
  ResponseFit fit;
  set_scale(fit, patches, options);
  return fit.response.clip_code;
}

Result<ResponseFit> fit_response(const PatchSet& given, const ResponseFitOptions& options) {
  ResponseFit fit;
  set_scale(fit, given, options);
  const auto patches =
      ordered_and_checked(at_exposure(given, fit.response.reference_exposure_us, options.luminance_error),
                          fit.response.clip_code, options.code_sigma);
  if (!patches) return patches.error();
  const auto in_file = [&](const Error& e) { return Error{e.kind, given.file + ": " + e.message}; };

  const std::vector<Trial> trials = attempt_curves(patches->fit, options);
  for (const Trial& trial : trials) fit.scores.push_back(trial.score);
  const Trial* chosen = choose(trials);
  if (chosen == nullptr)
    return in_file({ErrorKind::bad_input, "model " + std::string(name(trials.front().score.curve)) + ": " +
                                              trials.front().score.refused});
  fit.curve = chosen->score.curve;
  fit.curve_given = options.curve.has_value();
  fit.response.model = chosen->curve.fit.model;
  fit.response.black_code = std::min(black_code(fit.response), fit.response.clip_code - 1);
  if (const Status status = check(fit.response); !status) return in_file(status.error());
  fit.luminance_error = options.luminance_error;
  if (const Status status = set_covariance(fit, *chosen, several_exposures(given)); !status)
    return in_file(status.error());
  for (std::size_t i = 0; i < patches->fit.size(); ++i) {
    fit.fit.push_back(residual_of(fit, patches->fit[i], options.code_sigma));
    fit.fit.back().rejected = chosen->rejected == i;
  }
  for (const Patch& patch : patches->check) {
    fit.check.push_back(residual_of(fit, patch, options.code_sigma));
    fit.check.back().leverage = std::numeric_limits<double>::quiet_NaN();
  }
  fit.usable_codes = usable_codes(fit);
  return fit;
}

}  // namespace lightwell::calibration
