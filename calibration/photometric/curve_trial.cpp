// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/curve_trial.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/photometric/student.h"

namespace lightwell::calibration {
namespace {

constexpr double kRejectedChi2 = 25;  // what a patch that is left out costs a curve: five standard deviations
constexpr std::size_t kSuspects = 4;  // patches tried without; the first order misses where the curve bends
constexpr double kFalseRejection = 0.01;  // chance to reject any patch of a good set

using Points = std::vector<CurvePoint>;

double slope_of(const Model& model, double luminance_cd_m2) {
  const double h = std::max(1e-4 * luminance_cd_m2, 1e-12);
  return (model_code(model, luminance_cd_m2 + h) - model_code(model, luminance_cd_m2)) / h;
}

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
    const double degrees = kStatedNoiseResiduals + n - 1 - k;
    if (n < k + 2) return std::nullopt;  // the others could not tell
    const double least_t = student_two_sided(1 - kFalseRejection / n, degrees);
    // Leaving out takes at most all of χ² away.
    if (all.fit.chi2 * degrees / kStatedNoiseResiduals < least_t * least_t) return std::nullopt;
    std::optional<std::pair<Weighted, std::size_t>> best;
    for (const std::size_t i : most_influential(all)) {
      Points points = start_;
      points.erase(points.begin() + static_cast<std::ptrdiff_t>(i));
      auto fit = weighted(curve, segments, std::move(points));
      if (fit && (!best || fit->fit.chi2 < best->first.fit.chi2)) best = {*std::move(fit), i};
    }
    if (!best) return std::nullopt;
    const double scale = (kStatedNoiseResiduals + best->first.fit.chi2) / degrees;
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

}  // namespace

std::vector<Trial> attempt_curves(const std::vector<Patch>& patches, const ResponseFitOptions& options) {
  const Fitter fitter(patches, options);
  const std::optional<Curve>& wanted = options.curve;
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
  double least = std::numeric_limits<double>::infinity();
  for (const Trial& t : trials)
    if (t.score.refused.empty()) least = std::min(least, t.score.aicc);
  for (const Trial& t : trials)
    if (t.score.refused.empty() && t.score.aicc <= least + kStrongAicc) return &t;
  return nullptr;
}

}  // namespace lightwell::calibration
