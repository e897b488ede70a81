// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>

namespace lightwell::render {

enum class ToneMap { none, reinhard };
enum class Display { srgb, rec709, linear };
enum class FalseColour { none, luminance, stops };

// How radiance becomes codes of a display.
struct Look {
  ToneMap operation = ToneMap::reinhard;
  // By hand, for ISO 100; absent: Reinhard's operator adapts, and without an operator radiance 1 is white.
  std::optional<double> exposure_ev100;
  Display display = Display::srgb;
  FalseColour false_colour = FalseColour::none;
};

inline constexpr double kMiddleGrey = 0.18;  // Reinhard et al. 2002, eq. 2

// Luminance that a meter with K = 12.5 (ISO 2720) takes for the average at this exposure.
inline double metered_luminance_cd_m2(double ev100) {
  return std::exp2(ev100) * 12.5 / 100;
}
// Luminance that saturates a sensor at this exposure: 78 / (100 · 0.65) · 2^EV (ISO 12232; Lagarde and de Rousiers
// 2014, section 5.1.2).
inline double saturating_luminance_cd_m2(double ev100) {
  return std::exp2(ev100) * 1.2;
}

// Reinhard's two parameters, the log-average luminance and the white point, followed over time (Havran et al. 2005,
// section 4.4): smoothly, but at once where the picture changes by more than kCutStops, as at a cut or a switched lamp.
class Adaptation {
 public:
  static constexpr double kTimeConstant_s = 0.4;  // fast enough to follow a walk, too slow to follow flicker
  static constexpr double kCutStops = 2;          // more than an eye or a lens opens in a frame of walking

  // log_average, white: of the new picture, natural logarithms of cd/m². dt_s: since the picture before.
  void follow(double log_average, double log_white, double dt_s) {
    const bool cut = !adapted_ || std::abs(log_average - log_average_) > kCutStops * std::log(2.0);
    const double blend = cut ? 1 : 1 - std::exp(-std::fmax(dt_s, 0) / kTimeConstant_s);
    log_average_ += blend * (log_average - log_average_);
    log_white_ += blend * (log_white - log_white_);
    adapted_ = true;
  }
  [[nodiscard]] bool adapted() const { return adapted_; }
  [[nodiscard]] double average_cd_m2() const { return std::exp(log_average_); }
  [[nodiscard]] double white_cd_m2() const { return std::exp(log_white_); }

 private:
  bool adapted_ = false;
  double log_average_ = 0;
  double log_white_ = 0;
};

}  // namespace lightwell::render
