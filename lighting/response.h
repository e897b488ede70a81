// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <variant>
#include <vector>

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

// Lin-log sensor: linear to the knee, logarithmic above it, value and slope continuous there:
//   code = black + gain · L                        for L ≤ knee
//   code = black + gain · knee · (1 + ln(L/knee))  above
// gain, knee > 0.
struct LinLogResponse {
  double black = 0;
  double gain = 1;
  double knee_cd_m2 = 1;

  [[nodiscard]] double code(double luminance_cd_m2) const {
    const double x = luminance_cd_m2 <= knee_cd_m2
                         ? luminance_cd_m2
                         : knee_cd_m2 * (1 + std::log(luminance_cd_m2 / knee_cd_m2));
    return black + gain * x;
  }
  [[nodiscard]] double luminance_cd_m2(double code) const {
    const double x = (code - black) / gain;
    return x <= knee_cd_m2 ? x : knee_cd_m2 * std::exp(x / knee_cd_m2 - 1);
  }
  [[nodiscard]] double dluminance_dcode(double code) const {
    const double x = (code - black) / gain;
    return (x <= knee_cd_m2 ? 1 : std::exp(x / knee_cd_m2 - 1)) / gain;
  }
};

// Piecewise-linear companding (the knee points of IMX490 and AR0820 class sensors), and any measured table: straight
// lines between the points, the first and the last line going on beyond them. At least two points, luminance and
// code both strictly increasing. The derivative at a point is that of the line above it.
struct PiecewiseLinearResponse {
  struct Point {
    double luminance_cd_m2 = 0;
    double code = 0;
    friend bool operator==(const Point&, const Point&) = default;
  };
  std::vector<Point> points;

  [[nodiscard]] double code(double luminance_cd_m2) const;
  [[nodiscard]] double luminance_cd_m2(double code) const;
  [[nodiscard]] double dluminance_dcode(double code) const;
};

// The closed set of response models, with what every model shares.
struct Response {
  std::variant<LogResponse, LinearResponse, LinLogResponse, PiecewiseLinearResponse> model;
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

// The same sensor read out with another number of bits.
Response with_bits(const Response& response, int bits);

// Every field in range and the model increasing over the usable codes; the error names the field, value and range.
Status check(const Response& response);

}  // namespace lightwell
