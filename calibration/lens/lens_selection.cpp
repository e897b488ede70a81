// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/lens/lens_selection.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lightwell::calibration {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

std::size_t count_points(const std::vector<PosedView>& views) {
  std::size_t count = 0;
  for (const PosedView& view : views) count += view.points.size();
  return count;
}

double corrected_aic(double squared_error, std::size_t points, std::size_t views, int lens_parameters) {
  const double n = 2 * static_cast<double>(points);
  const double p = 6 * static_cast<double>(views) + lens_parameters + 1;  // and the noise
  if (n - p - 1 <= 0) return kNone;
  // Errors below a millionth of a pixel are rounding: they favour no model.
  return n * std::log(squared_error / n + 1e-12) + 2 * p + 2 * p * (p + 1) / (n - p - 1);
}

bool aspect_is_free(const Lens& lens, const std::vector<PosedView>& views) {
  double aic[2];
  for (const bool free : {false, true}) {
    Lens l = lens;
    std::vector<PosedView> v = views;
    const double error = adjust(l, v, {{4, free, true}, kNone, 30});
    aic[free] = corrected_aic(error, count_points(views), views.size(), free ? 8 : 7);
  }
  return aic[1] < aic[0];
}

// Points that nobody saw but a program computed: no detector is as exact.
constexpr double kComputedPx = 1e-4;

// The fewest coefficients that explain computed points, by Schwarz's criterion with an error of kComputedPx; nothing where
// four leave more than that.
std::optional<int> coefficients_of_computed(const Lens& lens, const std::vector<PosedView>& views,
                                            bool aspect) {
  const double n = 2 * static_cast<double>(count_points(views));
  const double noise2 = kComputedPx * kComputedPx;
  Lens l = lens;
  std::vector<PosedView> v = views;
  double best = kNone;
  std::optional<int> coefficients;
  for (int m = 4; m >= 0; --m) {
    const double error = adjust(l, v, {{m, aspect, true}, kNone, 60});
    if (m == 4 && !(error <= n * noise2)) return {};
    if (const double bic = error / noise2 + m * std::log(n); bic < best) {
      best = bic;
      coefficients = m;
    }
  }
  return coefficients;
}

}  // namespace

std::optional<TargetShape> supported_shape(const Lens& lens, const std::vector<PosedView>& views,
                                           const TargetShape& square) {
  constexpr double kDecisive = 10;
  constexpr double kFlat = 1e-6;  // of the board's width
  for (const PosedView& view : views)
    for (const Correspondence& p : view.points)
      if (std::abs(p.target_mm.z() - square.middle_mm.z()) > kFlat * square.half_mm) return {};
  TargetShape shape = square;
  double aic[2];
  for (const bool shaped : {false, true}) {
    Lens l = lens;
    std::vector<PosedView> v = views;
    const double error = adjust(l, v, {{}, kNone, 30}, shaped ? &shape : nullptr);
    aic[shaped] = corrected_aic(error, count_points(views), views.size(), shaped ? 13 : 8);
  }
  return aic[1] + kDecisive < aic[0] ? std::optional(shape) : std::nullopt;
}

double held_out_rms_px(const Lens& lens, const std::vector<PosedView>& views, const LensFreedom& freedom) {
  const std::size_t parts = std::min<std::size_t>(5, views.size());
  double sum = 0;
  for (std::size_t part = 0; part < parts; ++part) {
    std::vector<PosedView> fitted, kept;
    for (std::size_t i = 0; i < views.size(); ++i) (i % parts == part ? kept : fitted).push_back(views[i]);
    Lens l = lens;
    if (!(adjust(l, fitted, {freedom, kNone, 20, 1e-7}) >= 0)) return kNone;
    for (const PosedView& view : kept) {
      const TargetPose pose = refined_pose(l, view.pose, view.points, kNone);
      for (const double e : errors_px(l, pose, view.points)) sum += e * e;
    }
  }
  return std::sqrt(sum / static_cast<double>(count_points(views)));
}

LensSelection select_freedom(const Lens& lens, const std::vector<PosedView>& views) {
  LensFreedom freedom;
  freedom.aspect = aspect_is_free(lens, views);
  if (const auto computed = coefficients_of_computed(lens, views, freedom.aspect)) {
    freedom.coefficients = *computed;
    return {freedom, held_out_rms_px(lens, views, freedom)};
  }
  constexpr double kAsGood = 1.01;
  freedom.coefficients = 4;
  double error = held_out_rms_px(lens, views, freedom);
  // Down as long as fewer are clearly better; an infinite error, of views that do not determine the lens, is no
  // better than any.
  while (freedom.coefficients > 1) {
    LensFreedom fewer = freedom;
    --fewer.coefficients;
    const double without = held_out_rms_px(lens, views, fewer);
    if (!(error > kAsGood * without)) break;
    freedom = fewer;
    error = without;
  }
  return {freedom, error};
}

}  // namespace lightwell::calibration
