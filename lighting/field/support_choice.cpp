// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/support_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lighting/field/moving_least_squares.h"

namespace lightwell {
namespace {

constexpr std::size_t kForetold = 256;  // of a direction

}  // namespace

void SupportChoice::add(NearestSamples& samples) {
  const std::size_t count = samples.samples().size();
  const std::size_t step = (count + kForetold - 1) / kForetold;
  for (std::size_t i = 0; i < count; i += step) {
    const PlaneSample& sample = samples.samples()[i];
    for (std::size_t s = 0; s < kSupports.size(); ++s) {
      const auto fit = foretell(samples, i, kSupports[s]);
      if (!fit) break;  // by no support
      if (s == 0) square_radiance_ += sample.radiance.square().cast<double>().sum();
      square_error_[s] += (fit->radiance - sample.radiance).square().cast<double>().sum();
      has_foretold_ = true;
    }
  }
}

int SupportChoice::best() const {
  if (!(square_radiance_ > 0)) return kSupports[kSupports.size() / 2];
  return kSupports[static_cast<std::size_t>(std::min_element(square_error_.begin(), square_error_.end()) -
                                            square_error_.begin())];
}

double SupportChoice::held_out_error() const {
  if (!has_foretold_) return std::numeric_limits<double>::quiet_NaN();
  if (!(square_radiance_ > 0)) return 0;
  return std::sqrt(*std::min_element(square_error_.begin(), square_error_.end()) / square_radiance_);
}

}  // namespace lightwell
