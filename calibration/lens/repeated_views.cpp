// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/lens/repeated_views.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace lightwell::calibration {
namespace {

// The points of a view by their place on the target.
using Places = std::vector<Correspondence>;

auto key(const Correspondence& p) {
  return std::tuple(p.target_mm.x(), p.target_mm.y(), p.target_mm.z());
}

Places sorted(const TargetView& view) {
  Places out = view.points;
  std::sort(out.begin(), out.end(),
            [](const Correspondence& a, const Correspondence& b) { return key(a) < key(b); });
  return out;
}

bool is_repeat(const Places& a, const Places& b, double limit_px) {
  constexpr double kMostOfThem = 0.9;
  const auto fewer = static_cast<double>(std::min(a.size(), b.size()));
  // Most pairs of views end here, without a look at all their points.
  const double most = fewer * limit_px * limit_px / kMostOfThem;
  double sum = 0;
  std::size_t common = 0;
  for (std::size_t i = 0, k = 0; i < a.size() && k < b.size();) {
    if (key(a[i]) < key(b[k])) {
      ++i;
    } else if (key(b[k]) < key(a[i])) {
      ++k;
    } else {
      sum += (a[i++].pixel - b[k++].pixel).squaredNorm();
      ++common;
      if (!(sum <= most)) return false;
    }
  }
  const auto n = static_cast<double>(common);
  return n > 0 && n >= kMostOfThem * fewer && sum <= n * limit_px * limit_px;
}

}  // namespace

std::vector<std::optional<std::size_t>> repeated_views(const std::vector<TargetView>& views,
                                                       double noise_px) {
  const double limit_px = 3 * noise_px;
  std::vector<Places> places;
  for (const TargetView& view : views) places.push_back(sorted(view));
  std::vector<std::optional<std::size_t>> out(views.size());
  for (std::size_t late = 0; late < views.size(); ++late)
    for (std::size_t early = 0; early < late && !out[late]; ++early)
      if (!out[early] && is_repeat(places[early], places[late], limit_px)) out[late] = early;
  return out;
}

}  // namespace lightwell::calibration
