// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <variant>

#include "lighting/result.h"

namespace lightwell {

// Logarithmic sensor: code = a + b · ln(L + c), the linear toe made by c (Havran et al. 2005, section 5.1).
// L in cd/m² at the reference exposure; codes of the sensor's own bit depth. b > 0, c ≥ 0.
struct LogResponse {
  double a = 0;
  double b = 1;
  double c = 0;

  [[nodiscard]] double code(double luminance_cd_m2) const { return a + b * std::log(luminance_cd_m2 + c); }
  [[nodiscard]] double luminance_cd_m2(double code) const { return std::exp((code - a) / b) - c; }
  [[nodiscard]] double dluminance_dcode(double code) const { return std::exp((code - a) / b) / b; }
};

// code = black + gain · L, an ordinary sensor. gain > 0.
struct LinearResponse {
  double black = 0;
  double gain = 1;

  [[nodiscard]] double code(double luminance_cd_m2) const { return black + gain * luminance_cd_m2; }
  [[nodiscard]] double luminance_cd_m2(double code) const { return (code - black) / gain; }
  [[nodiscard]] double dluminance_dcode(double) const { return 1 / gain; }
};

// The closed set of response models, with what every model shares.
struct Response {
  std::variant<LogResponse, LinearResponse> model;
  int bits = 12;            // codes are 0 … 2^bits − 1
  double black_code = 0;    // smallest usable code
  double clip_code = 4095;  // codes at and above are clipped
  double reference_exposure_us =
      10000;  // exposure the model holds for; radiance scales with its ratio to the frame's

  [[nodiscard]] double code(double luminance_cd_m2) const {
    return std::visit([&](const auto& m) { return m.code(luminance_cd_m2); }, model);
  }
  [[nodiscard]] double luminance_cd_m2(double code) const {
    return std::visit([&](const auto& m) { return m.luminance_cd_m2(code); }, model);
  }
  [[nodiscard]] double dluminance_dcode(double code) const {
    return std::visit([&](const auto& m) { return m.dluminance_dcode(code); }, model);
  }
};

// Every field in range and the model increasing over the usable codes; the error names the field, value and range.
Status check(const Response& response);

}  // namespace lightwell
