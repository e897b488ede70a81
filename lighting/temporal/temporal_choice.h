// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lighting/light_set.h"
#include "lighting/result.h"
#include "lighting/sampling/light_arrays.h"
#include "lighting/temporal/light_filter.h"

namespace lightwell {

// What is done about flicker between frames, as on the command line.
enum class TemporalChoice {
  best,           // nothing after the fact: method best steadies its lights itself, without delay
  fir,            // Havran et al. 2005: nine taps, linear phase, four frames late
  minimum_phase,  // the same gains, three quarters of a frame late
  one_frame,      // four falling taps, one frame late
  none,           // every frame by itself
};
inline constexpr std::array kTemporalChoices = {TemporalChoice::best, TemporalChoice::fir,
                                                TemporalChoice::minimum_phase, TemporalChoice::one_frame,
                                                TemporalChoice::none};

std::string_view name(TemporalChoice choice);  // "minimum-phase"
std::optional<TemporalChoice> temporal_choice_from_name(std::string_view name);
std::string temporal_choice_names();

// The filter's taps, newest frame first, sum 1; {1} where there is none. fir and minimum_phase: equiripple,
// pass 7/21 and stop 9/21 of the rate (Havran et al. 2005, section 4.2). one_frame: .4 .3 .2 .1, which of all
// taps that delay slow changes by one frame keep least of white noise (variance .3; minimise Σ h² under Σ h = 1,
// Σ n h = 1: a falling line, ended where it would go below 0). None is negative, so a step comes without
// overshoot.
// rate_hz: above 0    fails: as design_fir
Result<std::vector<double>> temporal_taps(TemporalChoice choice, double rate_hz);

// Filters light sets whose light i is the same light in every frame (lighting/temporal/light_filter.h).
class LightSetFilter {
 public:
  LightSetFilter(const std::vector<double>& taps, std::size_t count, double theta_max_rad);
  // In place: lights and total_illuminance. set: of `count` lights
  void apply(LightSet& set);
  [[nodiscard]] double delay_frames() const { return filter_.delay_frames(); }

 private:
  LightFilter filter_;
  LightArrays in_, out_;
};

}  // namespace lightwell
