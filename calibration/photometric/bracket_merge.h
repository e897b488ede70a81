// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calibration/photometric/photograph.h"
#include "lighting/picture_map.h"
#include "lighting/response.h"
#include "lighting/result.h"

// Photographs at several exposures become one picture of radiance.
namespace lightwell::calibration {

inline constexpr int kDarkCode = 5, kClippedCode = 250;  // these and codes beyond are not measured by

// Of every code, 256; not negative.
std::vector<double> luminance_table(const Response& response);

// A channel of a pixel: exposures weighted by their time (light collected) where the code is between the ends.
struct MergedChannel {
  float sum = 0;  // cd/m² at the reference exposure
  float seconds = 0;

  void add(int code, const std::vector<double>& luminance, double exposure_s) {
    if (code <= kDarkCode || code >= kClippedCode) return;
    sum += static_cast<float>(luminance[static_cast<std::size_t>(code)]);  // · exposure / exposure
    seconds += static_cast<float>(exposure_s);
  }
  // 0 where no code was between the ends
  [[nodiscard]] double luminance_cd_m2(double reference_s) const {
    return seconds > 0 ? static_cast<double>(sum) * reference_s / static_cast<double>(seconds) : 0;
  }
};

// The mean radiance of every square of shrink × shrink pixels, of those at the far edges that of what there is. Codes
// are made radiance first, at the photographs' full size: the light of a lamp or stripe of one pixel is all there.
// clipped: a channel of a pixel of the square is clipped in all photographs. Holds 24 bytes a full pixel.
// photographs: one or more, of one full size
RadiancePicture merge_brackets(const std::vector<Photograph>& photographs, const Response& response,
                               int shrink);

}  // namespace lightwell::calibration
