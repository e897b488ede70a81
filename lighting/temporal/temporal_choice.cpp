// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/temporal/temporal_choice.h"

#include <utility>

#include "lighting/temporal/fir_design.h"

namespace lightwell {

std::string_view name(TemporalChoice choice) {
  switch (choice) {
    case TemporalChoice::best:
      return "best";
    case TemporalChoice::fir:
      return "fir";
    case TemporalChoice::minimum_phase:
      return "minimum-phase";
    case TemporalChoice::one_frame:
      return "one-frame";
    case TemporalChoice::none:
      return "none";
  }
  return "";
}

std::optional<TemporalChoice> temporal_choice_from_name(std::string_view wanted) {
  for (const TemporalChoice choice : kTemporalChoices)
    if (name(choice) == wanted) return choice;
  return std::nullopt;
}

std::string temporal_choice_names() {
  std::string names;
  for (const TemporalChoice choice : kTemporalChoices)
    names += (names.empty() ? "" : ", ") + std::string(name(choice));
  return names;
}

Result<std::vector<double>> temporal_taps(TemporalChoice choice, double rate_hz) {
  if (choice == TemporalChoice::one_frame) return std::vector<double>{0.4, 0.3, 0.2, 0.1};
  if (choice == TemporalChoice::best || choice == TemporalChoice::none) return std::vector<double>{1};
  auto design = design_fir({rate_hz, rate_hz * 7 / 21, rate_hz * 9 / 21, 8},
                           choice == TemporalChoice::fir ? FirPhase::linear : FirPhase::minimum);
  if (!design) return design.error();
  return std::move(design->taps);
}

LightSetFilter::LightSetFilter(const std::vector<double>& taps, std::size_t count, double theta_max_rad)
    : filter_(taps, count, theta_max_rad), in_(count), out_(count) {}

void LightSetFilter::apply(LightSet& set) {
  verify_bug(set.lights.size() == in_.size(), "the filter was made for another count of lights");
  for (std::size_t i = 0; i < in_.size(); ++i) {
    const DirectionalLight& light = set.lights[i];
    in_.x[i] = light.direction.x();
    in_.y[i] = light.direction.y();
    in_.z[i] = light.direction.z();
    in_.r[i] = light.illuminance[0];
    in_.g[i] = light.illuminance[1];
    in_.b[i] = light.illuminance[2];
  }
  filter_.apply(in_, out_);
  for (std::size_t i = 0; i < in_.size(); ++i) {
    set.lights[i].direction = {out_.x[i], out_.y[i], out_.z[i]};
    set.lights[i].illuminance = {out_.r[i], out_.g[i], out_.b[i]};
  }
  set.total_illuminance = Rgbd(sum_of(out_.r), sum_of(out_.g), sum_of(out_.b)).cast<float>();
}

}  // namespace lightwell
