// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/redundancy.h"

#include <utility>

#include "lighting/result.h"

namespace lightwell {

double picture_difference(std::span<const Rgb> a, std::span<const Rgb> b) {
  verify_bug(a.size() == b.size(), "pictures of one size");
  double difference = 0, energy = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d = static_cast<double>((a[i] - b[i]).abs().sum());
    if (!(d >= 0)) continue;  // NaN: one of them did not see it
    difference += d;
    energy += static_cast<double>((a[i] + b[i]).sum()) / 2;
  }
  return energy > 0 ? difference / energy : 0;
}

bool RedundancyFilter::is_redundant(const Picture& picture, const Picture& next) const {
  return last_kept_ && (next.position_m - last_kept_->position_m).norm() <= limits_.most_spacing_m &&
         picture_difference(last_kept_->seen, picture.seen) <= limits_.most_difference &&
         picture_difference(picture.seen, next.seen) <= limits_.most_difference;
}

void RedundancyFilter::add(const Vec3d& position_m, std::vector<Rgb> picture) {
  Picture next{position_m, std::move(picture)};
  if (candidate_ && is_redundant(*candidate_, next))
    kept_.back() = false;
  else
    last_kept_ = std::move(candidate_);
  candidate_ = std::move(next);
  kept_.push_back(true);
}

}  // namespace lightwell
