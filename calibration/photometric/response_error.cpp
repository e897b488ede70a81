// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/response_error.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/photometric/student.h"

namespace lightwell::calibration {

Status set_covariance(ResponseFit& fit, const Trial& trial, bool several_exposures) {
  const auto k = static_cast<Eigen::Index>(trial.score.parameters);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(k, k);
  for (const CurvePoint& p : trial.curve.points) {
    const Eigen::VectorXd j = dcode_dparameters(fit.response.model, p.luminance_cd_m2) / p.sigma;
    information += j * j.transpose();
  }
  // Parameters of very different size: scaled to a unit diagonal before the inverse.
  Eigen::VectorXd size = information.diagonal().cwiseSqrt();
  if (!(size.minCoeff() > 0))
    return Error{ErrorKind::bad_input, "no patch tells parameter " +
                                           parameter_names(fit.response.model)[static_cast<std::size_t>(
                                               std::min_element(size.begin(), size.end()) - size.begin())]};
  const Eigen::MatrixXd scaled =
      size.cwiseInverse().asDiagonal() * information * size.cwiseInverse().asDiagonal();
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(scaled);
  if (!lu.isInvertible())
    return Error{ErrorKind::bad_input,
                 "the patches do not tell the parameters apart: spread them over the range"};
  const double n = static_cast<double>(trial.curve.points.size());
  fit.degrees = kStatedNoiseResiduals + n - static_cast<double>(k);
  fit.noise_scale = std::sqrt((kStatedNoiseResiduals + trial.curve.fit.chi2) / fit.degrees);
  // Readings of one patch agree better than its luminance is known: that says nothing about the meter.
  if (several_exposures) fit.noise_scale = std::max(1.0, fit.noise_scale);
  fit.t95 = student_two_sided(0.95, fit.degrees);
  fit.covariance = fit.noise_scale * fit.noise_scale *
                   (size.cwiseInverse().asDiagonal() * lu.inverse() * size.cwiseInverse().asDiagonal());
  return {};
}

PatchResidual residual_of(const ResponseFit& fit, const Patch& patch, double code_sigma) {
  const Response& response = fit.response;
  PatchResidual out;
  out.patch = patch;
  out.luminance_cd_m2 = response.luminance_cd_m2(patch.code);
  out.code_residual = patch.code - response.code(patch.luminance_cd_m2);
  const double sigma_code = patch.code_sigma > 0 ? patch.code_sigma : code_sigma;
  if (!(patch.luminance_cd_m2 > 0 &&
        out.luminance_cd_m2 > 0)) {  // darkness has no logarithm: in absolute light
    const double nan = std::numeric_limits<double>::quiet_NaN();
    out.relative_error = patch.luminance_cd_m2 > 0 ? out.luminance_cd_m2 / patch.luminance_cd_m2 - 1 : nan;
    out.stops = nan;
    const Eigen::VectorXd j = dcode_dparameters(response.model, std::max(out.luminance_cd_m2, 0.0));
    const double of_fit = std::sqrt(std::max(0.0, j.dot(fit.covariance * j)));
    const double wide = fit.t95 * std::hypot(std::hypot(of_fit, fit.noise_scale * sigma_code) *
                                                 response.dluminance_dcode(patch.code),
                                             fit.noise_scale * fit.luminance_error * patch.luminance_cd_m2);
    out.interval = {std::max(0.0, out.luminance_cd_m2 - wide), std::max(0.0, out.luminance_cd_m2 + wide)};
  } else {
    const double ratio = out.luminance_cd_m2 / patch.luminance_cd_m2;
    out.relative_error = ratio - 1;
    out.stops = std::log2(ratio);
    const double of_code = sigma_code * response.dluminance_dcode(patch.code) / out.luminance_cd_m2;
    const double of_fit = fit.relative_sigma(patch.code);
    const double of_patch = fit.noise_scale * std::hypot(of_code, fit.luminance_error);
    const double sigma = std::hypot(of_fit, of_patch);
    out.leverage = std::min(1.0, of_fit * of_fit / (of_patch * of_patch));
    // In the logarithm, as relative errors are; where the light is no more than its error, down to 0.
    const double wide = fit.t95 * sigma;
    out.interval = {wide < 1 ? out.luminance_cd_m2 * std::exp(-wide) : 0,
                    out.luminance_cd_m2 * std::exp(std::min(wide, 100.0))};
  }
  out.inside = patch.luminance_cd_m2 >= out.interval[0] && patch.luminance_cd_m2 <= out.interval[1];
  return out;
}

// The longest run of codes between the patches where the error is small enough.
std::optional<std::array<double, 2>> usable_codes(const ResponseFit& fit) {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  for (const PatchResidual& r : fit.fit) {
    if (r.rejected || !(r.patch.luminance_cd_m2 > 0)) continue;
    const double code = fit.response.code(r.patch.luminance_cd_m2);
    low = std::min(low, code);
    high = std::max(high, code);
  }
  constexpr int kSteps = 1000;
  std::optional<std::array<double, 2>> best;
  std::optional<double> begin;
  for (int i = 0; i <= kSteps; ++i) {
    const double code = low + (high - low) * i / kSteps;
    if (!(fit.relative_error_95(code) < kUsableError)) {
      begin.reset();
      continue;
    }
    if (!begin) begin = code;
    if (!best || code - *begin > (*best)[1] - (*best)[0]) best = {*begin, code};
  }
  return best;
}

double ResponseFit::relative_sigma(double code) const {
  const double luminance = response.luminance_cd_m2(code);
  const Eigen::VectorXd j = dcode_dparameters(response.model, std::max(luminance, 0.0));
  const double sigma_code = std::sqrt(std::max(0.0, j.dot(covariance * j)));
  return luminance > 0 ? sigma_code * response.dluminance_dcode(code) / luminance
                       : std::numeric_limits<double>::infinity();
}

}  // namespace lightwell::calibration
