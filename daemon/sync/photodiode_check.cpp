// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/photodiode_check.h"

#include <algorithm>
#include <cmath>

namespace lightwell {

void PhotodiodeCheck::add(double photodiode_lx, double camera_lx) noexcept {
  if (!(photodiode_lx >= kDarkLx) || !(camera_lx >= kDarkLx) || !std::isfinite(camera_lx)) return;
  photodiode_lx_ = photodiode_lx;
  camera_lx_ = camera_lx;
  ratios_[count_++ % kReadings] = camera_lx / photodiode_lx;
}

std::optional<PhotodiodeCheck::Verdict> PhotodiodeCheck::verdict() const noexcept {
  if (count_ < kEnough) return std::nullopt;
  const std::size_t known = std::min(count_, kReadings);
  std::array<double, kReadings> sorted = ratios_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(known / 2);
  std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(known));
  const double ratio = *middle;
  return Verdict{photodiode_lx_, camera_lx_, ratio, ratio > kMostRatio || ratio < 1 / kMostRatio};
}

}  // namespace lightwell
