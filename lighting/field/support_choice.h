// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lighting/field/nearest_samples.h"

namespace lightwell {

// Over how many of the nearest rays to fit, chosen by held-out rays: each in turn is foretold from those of other places.
// Few follow an edge closely, many average noise; the take says which it needs.
class SupportChoice {
 public:
  // Adds one direction: its rays, all or every n-th foretold so that a direction costs no more than a few hundred fits.
  void add(NearestSamples& samples);

  // The support that foretold best so far, the middle one where nothing was foretold.
  [[nodiscard]] int best() const;
  // Its error: RMS of radiance foretold less radiance measured, over the RMS of radiance measured. 0 in darkness, NaN
  // where nothing was foretold, as all rays of a direction lie in one place.
  [[nodiscard]] double held_out_error() const;

  static constexpr std::array<int, 7> kSupports = {4, 6, 9, 13, 19, 28, 40};

 private:
  std::array<double, kSupports.size()> square_error_{};
  double square_radiance_ = 0;
  bool has_foretold_ = false;
};

}  // namespace lightwell
