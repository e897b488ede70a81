// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lighting/response.h"

namespace lightwell::calibration {

// What one take says of one pixel: its mean code, the luminance it should see, the standard error of the code.
struct PixelReading {
  double code = 0, luminance_cd_m2 = 0, sigma_code = 0;
  double shared_sigma_code = 0;  // of the luminance's code, in which all pixels err together
};

// Each pixel's offset, and its gain where the takes tell it.
struct PixelPattern {
  std::vector<float> offset_codes;  // of each pixel, 0 where it has no reading
  std::vector<float> gain;          // 1 likewise; empty: not supported
  double gain_rms = 0;              // spread of the estimated gains about 1
  double gain_sigma =
      0;  // of that, noise and shared errors; infinite: the takes cannot tell gain from offset
};

// code = response(gain · luminance) + offset for every reading of a pixel, weighted least squares by Gauss–Newton on
// ln gain. Offset and gain come apart only where the slope dcode/dln L differs between the readings: dark frames and
// bright ones of a linear sensor, not two lights on the straight part of a logarithmic one.
// A gain corrects and adds its own noise; it is kept where it takes out more than it adds: where the spread of the
// estimates is over √2 times their standard error. Else every pixel gets the mean of its residuals as its offset.
// readings: [pixel][take], empty where a pixel has none.
PixelPattern fit_pattern(const std::vector<std::vector<PixelReading>>& readings, const Response& response);

}  // namespace lightwell::calibration
