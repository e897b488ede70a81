// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/response_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/photometric/student.h"

namespace lightwell::calibration {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kPrior = 4;          // residuals that the stated noise counts for
constexpr double kRejectedChi2 = 25;  // what a patch that is left out costs a curve: five standard deviations
constexpr std::size_t kSuspects = 4;  // patches tried without; the first order misses where the curve bends
constexpr double kFalseRejection = 0.01;  // chance to reject any patch of a good set

using Points = std::vector<CurvePoint>;

double slope_of(const Model& model, double luminance_cd_m2) {
  const double h = std::max(1e-4 * luminance_cd_m2, 1e-12);
  return (model_code(model, luminance_cd_m2 + h) - model_code(model, luminance_cd_m2)) / h;
}

// A curve with weights that its own slope gave.
struct Weighted {
  CurveFit fit;
  Points points;
  [[nodiscard]] double deviance() const {  // −2 ln likelihood, up to a constant
    double sum = fit.chi2;
    for (const CurvePoint& p : points) sum += 2 * std::log(p.sigma);
    return sum;
  }
};

struct Trial {
  CurveScore score;
  Weighted curve;
  std::optional<std::size_t> rejected;
};

class Fitter {
 public:
  Fitter(const std::vector<Patch>& patches, const ResponseFitOptions& options)
      : patches_(patches), options_(options) {
    const std::size_t n = patches.size();
    for (std::size_t i = 0; i < n; ++i) {  // slopes from the neighbours, for the first weights
      const Patch &a = patches[i > 0 ? i - 1 : 0], &b = patches[std::min(i + 1, n - 1)];
      const double slope = (b.code - a.code) / (b.luminance_cd_m2 - a.luminance_cd_m2);
      start_.push_back({patches[i].luminance_cd_m2, patches[i].code, sigma(patches[i], slope)});
    }
  }

  [[nodiscard]] double sigma(const Patch& patch, double dcode_dluminance) const {
    const double code = patch.code_sigma > 0 ? patch.code_sigma : options_.code_sigma;
    const double relative = patch.luminance_error > 0 ? patch.luminance_error : options_.luminance_error;
    return std::hypot(code, dcode_dluminance * patch.luminance_cd_m2 * relative);
  }

  [[nodiscard]] Trial attempt(Curve curve, int segments) const {
    Trial trial;
    trial.score.curve = curve;
    trial.score.segments = segments;
    trial.score.parameters = curve == Curve::linear ? 2 : curve == Curve::pwl ? 2 * segments : 3;
    const auto k = static_cast<std::size_t>(trial.score.parameters);
    if (patches_.size() < k + 1) {
      trial.score.refused = std::to_string(k) + " parameters need " + std::to_string(k + 1) +
                            " patches, there are " + std::to_string(patches_.size());
      return trial;
    }
    auto all = weighted(curve, segments, start_);
    const auto without = all ? best_without_one(curve, segments, *all) : std::nullopt;
    if (without) {
      trial.curve = without->first;
      trial.rejected = without->second;
    } else if (all) {
      trial.curve = *std::move(all);
    } else {
      trial.score.refused = curve == Curve::linear || curve == Curve::log
                                ? "does not rise"
                                : "has no knee between the patches, or does not rise";
      return trial;
    }
    score(trial);
    return trial;
  }

 private:
  [[nodiscard]] std::optional<Weighted> weighted(Curve curve, int segments, Points points) const {
    std::optional<CurveFit> fit;
    for (int round = 0; round < 4; ++round) {  // the slope settles in two
      fit = fit_curve(curve, points, segments);
      if (!fit) return std::nullopt;
      if (round == 3) break;
      for (CurvePoint& p : points) {
        const auto patch =
            std::lower_bound(patches_.begin(), patches_.end(), p.luminance_cd_m2,
                             [](const Patch& c, double luminance) { return c.luminance_cd_m2 < luminance; });
        p.sigma = sigma(*patch, slope_of(fit->model, p.luminance_cd_m2));
      }
    }
    return Weighted{*std::move(fit), std::move(points)};
  }

  // The patches whose loss would take the most χ² away, to first order: residual² / (1 − leverage).
  [[nodiscard]] std::vector<std::size_t> most_influential(const Weighted& all) const {
    const auto n = static_cast<Eigen::Index>(all.points.size());
    Eigen::MatrixXd jacobian(n, static_cast<Eigen::Index>(parameters_of(all.fit.model).size()));
    for (Eigen::Index i = 0; i < n; ++i) {
      const CurvePoint& p = all.points[static_cast<std::size_t>(i)];
      jacobian.row(i) = dcode_dparameters(all.fit.model, p.luminance_cd_m2).transpose() / p.sigma;
    }
    for (auto column : jacobian.colwise())
      if (const double length = column.norm(); length > 0) column /= length;
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(jacobian);
    const Eigen::MatrixXd q = qr.householderQ() * Eigen::MatrixXd::Identity(n, qr.rank());
    std::vector<std::pair<double, std::size_t>> loss;
    for (std::size_t i = 0; i < all.points.size(); ++i) {
      const CurvePoint& p = all.points[i];
      const double r = (p.code - model_code(all.fit.model, p.luminance_cd_m2)) / p.sigma;
      const double free = 1 - q.row(static_cast<Eigen::Index>(i)).squaredNorm();
      loss.emplace_back(-r * r / std::max(free, 1e-9), i);
    }
    std::sort(loss.begin(), loss.end());
    std::vector<std::size_t> out;
    for (std::size_t i = 0; i < std::min(loss.size(), kSuspects); ++i) out.push_back(loss[i].second);
    return out;
  }

  // The fit without the one patch that contradicts the others, where there is one.
  [[nodiscard]] std::optional<std::pair<Weighted, std::size_t>> best_without_one(Curve curve, int segments,
                                                                                 const Weighted& all) const {
    const auto n = static_cast<double>(patches_.size());
    const double k = curve == Curve::linear ? 2 : curve == Curve::pwl ? 2 * segments : 3;
    const double degrees = kPrior + n - 1 - k;
    if (n < k + 2) return std::nullopt;  // the others could not tell
    const double least_t = student_two_sided(1 - kFalseRejection / n, degrees);
    // Leaving out takes at most all of χ² away.
    if (all.fit.chi2 * degrees / kPrior < least_t * least_t) return std::nullopt;
    std::optional<std::pair<Weighted, std::size_t>> best;
    for (const std::size_t i : most_influential(all)) {
      Points points = start_;
      points.erase(points.begin() + static_cast<std::ptrdiff_t>(i));
      auto fit = weighted(curve, segments, std::move(points));
      if (fit && (!best || fit->fit.chi2 < best->first.fit.chi2)) best = {*std::move(fit), i};
    }
    if (!best) return std::nullopt;
    const double scale = (kPrior + best->first.fit.chi2) / degrees;
    const double t = std::sqrt(std::max(0.0, all.fit.chi2 - best->first.fit.chi2) / scale);
    if (t > least_t) return best;
    return std::nullopt;
  }

  void score(Trial& trial) const {
    const auto n = static_cast<double>(patches_.size());
    const double k = trial.score.parameters;
    trial.score.chi2 = trial.curve.fit.chi2;
    double deviance = trial.curve.deviance();
    if (trial.rejected) {
      const Patch& patch = patches_[*trial.rejected];
      deviance +=
          kRejectedChi2 + 2 * std::log(sigma(patch, slope_of(trial.curve.fit.model, patch.luminance_cd_m2)));
    }
    // One patch more than parameters would make the correction infinite, though the noise is stated.
    trial.score.aicc = deviance + 2 * k + 2 * k * (k + 1) / std::max(n - k - 1, 0.5);
  }

  const std::vector<Patch>& patches_;
  const ResponseFitOptions& options_;
  Points start_;
};

std::vector<Trial> attempt_all(const Fitter& fitter, const std::optional<Curve>& wanted) {
  constexpr int kMostSegments = 4;
  std::vector<Trial> trials;
  for (const Curve curve : {Curve::linear, Curve::log, Curve::linlog})
    if (!wanted || *wanted == curve) trials.push_back(fitter.attempt(curve, 0));
  if (!wanted || *wanted == Curve::pwl)
    for (int segments = 2; segments <= kMostSegments; ++segments)
      trials.push_back(fitter.attempt(Curve::pwl, segments));
  return trials;
}

// The first, in the order above, that is as good as the one of least AICc. The order is that of the number of
// parameters; of two curves with three, the logarithm comes before the one with a knee. The least of the two would be a
// toss where no patch tells them apart: a toe of half the darkest patch, six patches with 1 % error, is named linlog in
// two sets of five, while a knee between such patches is better by 16 or more in all of 200.
const Trial* choose(const std::vector<Trial>& trials) {
  double least = kNever;
  for (const Trial& t : trials)
    if (t.score.refused.empty()) least = std::min(least, t.score.aicc);
  for (const Trial& t : trials)
    if (t.score.refused.empty() && t.score.aicc <= least + kStrongAicc) return &t;
  return nullptr;
}

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

Status set_covariance(ResponseFit& fit, const Trial& trial, bool several) {
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
  fit.degrees = kPrior + n - static_cast<double>(k);
  fit.noise_scale = std::sqrt((kPrior + trial.curve.fit.chi2) / fit.degrees);
  // Readings of one patch agree better than its luminance is known: that says nothing about the meter.
  if (several) fit.noise_scale = std::max(1.0, fit.noise_scale);
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
std::optional<std::array<double, 2>> usable(const ResponseFit& fit) {
  double low = kNever, high = -kNever;
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

}  // namespace

double ResponseFit::relative_sigma(double code) const {
  const double luminance = response.luminance_cd_m2(code);
  const Eigen::VectorXd j = dcode_dparameters(response.model, std::max(luminance, 0.0));
  const double sigma_code = std::sqrt(std::max(0.0, j.dot(covariance * j)));
  return luminance > 0 ? sigma_code * response.dluminance_dcode(code) / luminance : kNever;
}

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

  const Fitter fitter(patches->fit, options);
  const std::vector<Trial> trials = attempt_all(fitter, options.curve);
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
  fit.usable_codes = usable(fit);
  return fit;
}

}  // namespace lightwell::calibration
