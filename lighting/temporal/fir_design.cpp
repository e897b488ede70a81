// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/temporal/fir_design.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <string>
#include <utility>

// After <complex>, so that liquid's complex types are C++'s.
#include <liquid/liquid.h>

#include "lighting/temporal/minimum_phase.h"
#include "lighting/vector.h"

namespace lightwell {
namespace {

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

Error out_of_range(const char* name, double value, const std::string& range) {
  return {ErrorKind::usage, std::string(name) + " " + number(value) + " is out of range: " + range};
}

// Points of the dense grid on which a design is measured: 16 a tap see every ripple.
int dense_points(int order) {
  return 64 * (order + 1);
}

double largest_deviation(const std::vector<double>& taps, double from_hz, double to_hz, double rate_hz,
                         double wanted) {
  const int points = dense_points(static_cast<int>(taps.size()));
  double largest = 0;
  for (int i = 0; i <= points; ++i) {
    const double f = from_hz + (to_hz - from_hz) * i / points;
    largest = std::max(largest, std::abs(fir_gain(taps, f, rate_hz) - wanted));
  }
  return largest;
}

}  // namespace

Status check(const FirSpecification& s) {
  constexpr double kLargestRate = 100000;
  if (!(s.rate_hz > 0 && s.rate_hz <= kLargestRate))
    return out_of_range("rate", s.rate_hz, "above 0 to 100000 Hz");
  if (!(s.stop_hz > 0 && s.stop_hz < s.rate_hz / 2))
    return out_of_range("stop", s.stop_hz,
                        "above 0 and below half the rate, " + number(s.rate_hz / 2) + " Hz");
  if (!(s.pass_hz > 0 && s.pass_hz < s.stop_hz))
    return out_of_range("pass", s.pass_hz, "above 0 and below stop, " + number(s.stop_hz) + " Hz");
  if (s.order < 1 || s.order > kLargestFirOrder)
    return out_of_range("order", s.order, "1 to " + std::to_string(kLargestFirOrder));
  return {};
}

double fir_gain(const std::vector<double>& taps, double frequency_hz, double rate_hz) {
  std::complex<double> sum = 0;
  for (std::size_t n = 0; n < taps.size(); ++n)
    sum += taps[n] * std::polar(1.0, -2 * kPi * frequency_hz / rate_hz * static_cast<double>(n));
  return std::abs(sum);
}

Result<FirDesign> design_fir(const FirSpecification& s, FirPhase phase) {
  if (Status status = check(s); !status) return status.error();
  std::array<float, 4> bands = {0, static_cast<float>(s.pass_hz / s.rate_hz),
                                static_cast<float>(s.stop_hz / s.rate_hz), 0.5f};
  std::array<float, 2> wanted = {1, 0};
  std::array<float, 2> weights = {1, 1};
  std::array<liquid_firdespm_wtype, 2> weight_types = {LIQUID_FIRDESPM_FLATWEIGHT,
                                                       LIQUID_FIRDESPM_FLATWEIGHT};
  std::vector<float> raw(static_cast<std::size_t>(s.order) + 1, 0.0f);
  firdespm_run(static_cast<unsigned>(raw.size()), 2, bands.data(), wanted.data(), weights.data(),
               weight_types.data(), LIQUID_FIRDESPM_BANDPASS, raw.data());

  FirDesign design;
  double sum = 0;
  for (const float tap : raw) sum += static_cast<double>(tap);
  // An exchange that failed leaves zeros, NaN or a filter that passes nothing.
  const auto not_found = [&] {
    return Error{ErrorKind::failed, "no equiripple filter of order " + std::to_string(s.order) +
                                        " found for pass " + number(s.pass_hz) + " Hz, stop " +
                                        number(s.stop_hz) + " Hz at " + number(s.rate_hz) +
                                        " Hz: widen the gap between pass and stop or lower the order"};
  };
  if (!(std::isfinite(sum) && sum > 0.1)) return not_found();
  design.taps.resize(raw.size());
  for (std::size_t i = 0; i < raw.size(); ++i)  // symmetric to the last bit
    design.taps[i] = (static_cast<double>(raw[i]) + static_cast<double>(raw[raw.size() - 1 - i])) / 2 / sum;
  // Long filters are beyond what the exchange can tell apart; it ends somewhere, with bands that are none.
  constexpr int kSureOrder = 64;
  constexpr double kNoBand = 0.1;
  if (s.order > kSureOrder &&
      (largest_deviation(design.taps, 0, s.pass_hz, s.rate_hz, 1) > kNoBand ||
       largest_deviation(design.taps, s.stop_hz, s.rate_hz / 2, s.rate_hz, 0) > kNoBand))
    return not_found();
  if (phase == FirPhase::minimum) {
    auto least_delay = minimum_phase(design.taps);
    if (!least_delay) return least_delay.error();
    design.taps = std::move(least_delay).value();
  }
  design.dc_gain = fir_gain(design.taps, 0, s.rate_hz);
  design.delay_frames = phase == FirPhase::linear ? s.order / 2.0 : delay_of_slow_changes(design.taps);
  design.pass_ripple_db = 20 * std::log10(1 + largest_deviation(design.taps, 0, s.pass_hz, s.rate_hz, 1));
  design.stop_attenuation_db =
      -20 * std::log10(largest_deviation(design.taps, s.stop_hz, s.rate_hz / 2, s.rate_hz, 0));
  return design;
}

}  // namespace lightwell
