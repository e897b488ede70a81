// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "calibration/photometric/patches.h"
#include "calibration/photometric/response_curve.h"
#include "calibration/photometric/response_fit.h"

// Which form of curve the patches support, and which of them contradicts the others: see fit_response.
namespace lightwell::calibration {

// Residuals that the stated noise counts for, beside those of the patches.
inline constexpr double kStatedNoiseResiduals = 4;

// A curve with weights that its own slope gave.
struct Weighted {
  CurveFit fit;
  std::vector<CurvePoint> points;
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

// Linear, log, linlog, and pwl of two to four segments, or those of the wanted curve. patches: the set's fit, by
// rising luminance
std::vector<Trial> attempt_curves(const std::vector<Patch>& patches, const ResponseFitOptions& options);

// The first that is as good as the one of least AICc, which no other is better than by kStrongAicc; nullptr: all are
// refused.
const Trial* choose(const std::vector<Trial>& trials);

}  // namespace lightwell::calibration
