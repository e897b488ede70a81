// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/quality_control.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "lighting/median.h"

namespace lightwell::render {
namespace {

// Between these shares of the frame's time nothing is given up or taken; what is taken is to leave it below kRoom.
constexpr double kFull = 0.95, kLoose = 0.75, kRoom = 0.88;
constexpr double kFirstLights = 16;
constexpr double kLeastTexels = 1.0 / 16;  // a quarter of a map's side
// Steps of a sixteenth, longer ones where the time is far off.
constexpr double kPace = 1.0 / 16, kFarPace = 0.2;
// Of a knob's value, a frame: what changes fades in over three frames.
constexpr double kFade = kPace / 3;
constexpr std::size_t kFramesToJudge = 3;
// Before it is known: what share of a frame's time goes with the logarithm of lights, and of texels.
constexpr std::array<double, 2> kFirstCost = {0.8, 0.2};
constexpr double kNoError = 1e-9;
// Of the maps: fewer of them drawn count as so many, and below kStanding giving up texels is no way to save time.
constexpr double kLeastDrawn = 0.01, kStanding = 0.3;
// How much better an exchange must be than leaving it.
constexpr double kClearly = 2;
// The least and the most that a measured cost may be, of the frame: no hiccup makes a knob free or forbidden.
constexpr double kLeastCost = 0.002, kMostCost = 1.5;

double& value_of(Quality& quality, std::size_t knob) {
  return knob == 0 ? quality.lights : quality.texels;
}

}  // namespace

void QualityControl::frame_took(double ms, double maps_drawn) {
  maps_drawn_ += (std::clamp(maps_drawn, kLeastDrawn, 1.0) - maps_drawn_) / 2;
  ms_[frames_ % ms_.size()] = ms;
  ++frames_;
}

// One slow frame is no reason.
double QualityControl::median_ms() const {
  const auto known = static_cast<std::ptrdiff_t>(std::min(frames_, ms_.size()));
  return median(std::vector<double>(ms_.begin(), ms_.begin() + known));
}

QualityControl::Step QualityControl::step(std::size_t knob, bool up, double most_lights, double pace,
                                          const Error& error) const {
  Step step;
  step.knob = knob;
  step.after = shown_;
  double& value = value_of(step.after, knob);
  const double before = value;
  // Of texels a sixteenth would not be told from noise.
  if (knob == 1) pace = kFarPace;
  value *= up ? 1 + pace : 1 / (1 + pace);
  if (knob == 0) {
    value = up ? std::max(std::floor(value), before + 1) : std::min(std::ceil(value), before - 1);
    value = std::clamp(value, 1.0, most_lights);
  } else {
    value = std::clamp(value, kLeastTexels, 1.0);
  }
  step.logarithm = std::log(value / before);
  step.error = std::max(0.0, (up ? 1 : -1) * (error(shown_) - error(step.after)));
  return step;
}

void QualityControl::learn(double ms) {
  for (std::size_t knob = 0; knob < kKnobs; ++knob)
    if (!(cost_ms_[knob] > 0)) cost_ms_[knob] = kFirstCost[knob] * ms;
  if (last_.logarithm == 0) return;
  if (last_.knob == 1 && maps_drawn_ < kStanding) {
    last_.logarithm = 0;
    return;
  }
  const double measured = std::clamp((ms - ms_before_) / last_.logarithm, kLeastCost * ms, kMostCost * ms);
  double& cost = cost_ms_[last_.knob];
  cost += (measured - cost) / (std::exchange(measured_[last_.knob], true) ? 4 : 1);  // times are noisy
  last_.logarithm = 0;
}

void QualityControl::take(const Step& step, double ms) {
  last_ = step;
  ms_before_ = ms;
  wanted_ = step.after;
}

// The step that is worth most: of error for its time up, of time for its error down.
std::optional<QualityControl::Step> QualityControl::best(const Steps& steps, bool up, double ms) const {
  std::optional<Step> best;
  double most = -1;
  for (const Step& step : steps) {
    if (step.logarithm == 0) continue;
    if (up && ms + time_of(step) > kRoom * frame_ms_) continue;
    if (!up && step.knob == 1 && maps_drawn_ < kStanding) continue;
    const double worth = up ? step.error / time_of(step) : time_of(step) / std::max(step.error, kNoError);
    if (worth > most) best = step, most = worth;
  }
  return best;
}

// Less of one knob for more of the other, where that is clearly worth it; never back again.
std::optional<QualityControl::Step> QualityControl::exchange(const Steps& down, const Steps& up) const {
  for (std::size_t less = 0; less < kKnobs; ++less) {
    const Step& give = down[less];
    const Step& get = up[1 - less];
    if (give.logarithm == 0 || get.logarithm == 0 || given_ == 1 - less) continue;
    if (less == 1 && maps_drawn_ < kStanding) continue;
    if (get.error * time_of(give) > kClearly * give.error * time_of(get)) return give;
  }
  return std::nullopt;
}

void QualityControl::decide(double most_lights, const Error& error) {
  const double ms = median_ms();
  learn(ms);
  const double used = ms / frame_ms_;
  const double pace = used > 1.5 || used < 0.4 ? kFarPace : kPace;
  const auto steps = [&](bool up) {
    return Steps{step(0, up, most_lights, pace, error), step(1, up, most_lights, pace, error)};
  };
  if (used > kFull || used < kLoose) given_.reset();
  if (used > kFull) {
    if (const auto step = best(steps(false), false, ms)) take(*step, ms);
    return;
  }
  Steps up = steps(true);
  // What was given for the other is not taken again.
  if (given_) up[*given_].logarithm = 0;
  if (used < kLoose || given_) {
    if (const auto step = best(up, true, ms)) {
      take(*step, ms);
      return;
    }
  }
  if (const auto step = exchange(steps(false), up)) {
    take(*step, ms);
    given_ = step->knob;
  }
}

// A part of the way to what is wanted.
void QualityControl::approach(double most_lights) {
  if (wanted_.lights > most_lights) {
    wanted_.lights = most_lights;
    last_.logarithm = 0;  // what comes now is no answer to the step
  }
  bool changed = false;
  for (std::size_t knob = 0; knob < kKnobs; ++knob) {
    double& value = value_of(shown_, knob);
    const double wanted = value_of(wanted_, knob);
    if (value == wanted) continue;
    const double most = std::max(kFade * value, knob == 0 ? 1.0 / 3 : 0.0);
    value = std::abs(wanted - value) <= most * 1.001 ? wanted : value + std::copysign(most, wanted - value);
    changed = true;
  }
  if (changed) frames_ = 0;
}

Quality QualityControl::choose(double most_lights, const Error& error) {
  if (shown_.lights == 0) shown_.lights = wanted_.lights = std::min(most_lights, kFirstLights);
  const bool there = shown_.lights == wanted_.lights && shown_.texels == wanted_.texels;
  if (there && frames_ >= kFramesToJudge) decide(most_lights, error);
  approach(most_lights);
  return shown_;
}

}  // namespace lightwell::render
