// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lighting/result.h"

namespace lightwell {

enum class FirPhase {
  linear,   // every frequency is late by order / 2 frames
  minimum,  // the same gains with the least delay (lighting/temporal/minimum_phase.h)
};

// What the temporal low-pass filter shall do, frequencies in hertz.
struct FirSpecification {
  double rate_hz = 60;      // frames a second
  double pass_hz = 20;      // changes up to here pass
  double stop_hz = 25.714;  // changes from here on are suppressed
  int order = 8;            // taps − 1
};

// A low-pass filter and what it was measured to do.
struct FirDesign {
  std::vector<double> taps;   // newest frame first, sum 1; symmetric where the phase is linear
  double dc_gain = 1;         // sum of the taps
  double delay_frames = 0;    // of slow changes; order / 2 where the phase is linear
  double pass_ripple_db = 0;  // largest |gain| deviation from 1 up to pass_hz, as 20 log10(1 + deviation)
  double stop_attenuation_db = 0;  // −20 log10 of the largest gain from stop_hz up
};

inline constexpr int kLargestFirOrder = 128;

// 0 < pass < stop < rate / 2, rate in (0, 100000] Hz, order 1 to 128, all finite; the error (usage) names
// option, value and range.
Status check(const FirSpecification& specification);

// Equiripple design by the Parks–McClellan exchange, equal weight on both bands, scaled to gain 1 for a
// constant. source: Parks and McClellan 1972; Havran et al. 2005, section 3.3, whose printed taps sum to 1.09
// Fails (usage) as check does, and (failed) where the exchange does not converge to a usable filter, or its zeros are not found.
Result<FirDesign> design_fir(const FirSpecification& specification, FirPhase phase = FirPhase::linear);

// |H| of symmetric or any real taps at a frequency.
double fir_gain(const std::vector<double>& taps, double frequency_hz, double rate_hz);

}  // namespace lightwell
