// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/light_budget.h"

#include <algorithm>
#include <cmath>

#include "render/fade_lights.h"

namespace lightwell::render {
namespace {

// Lights are given up only where the error stays this far below what is allowed: else their number would flutter.
constexpr double kSafe = 0.9;

std::size_t step(std::size_t count) {
  return std::max<std::size_t>(1, count / 16);
}

// Of lights that carry no prediction, n of them: what lights of best err in the judged scenes (8 to 216 of them).
double usual_error(double lights) {
  return 0.9 * std::pow(lights, -0.8);
}

// What maps of 256² add in the judged scenes, as the square root of a sum of squares (docs/decisions/046); their error is
// that of a texel's blur.
double map_error(double texels, int shadow_size) {
  return 0.006 * 256 / shadow_size / std::sqrt(texels);
}

double light_error(const LightSet& all, double lights) {
  const auto predicted = [&](std::size_t n) {
    const auto error =
        static_cast<double>(all.lights[std::clamp<std::size_t>(n, 1, all.lights.size()) - 1].predicted_error);
    return error > 0 ? error : usual_error(static_cast<double>(std::max<std::size_t>(n, 1)));
  };
  const auto fewer = static_cast<std::size_t>(lights);
  return std::lerp(predicted(fewer), predicted(fewer + 1), lights - static_cast<double>(fewer));
}

}  // namespace

LightBudget::LightBudget(const Goals& goals) : goals_(goals) {
  if (goals_.fps) control_.emplace(*goals_.fps);
}

std::size_t LightBudget::needed(const LightSet& all, std::size_t now) const {
  const auto fewest = [&](double error) {
    std::size_t n = 1;
    while (n < all.lights.size() && static_cast<double>(all.lights[n - 1].predicted_error) > error) ++n;
    return n;
  };
  const std::size_t least = fewest(*goals_.max_error);
  if (now == 0 || least >= now) return least;
  return std::max(std::min(now, fewest(kSafe * *goals_.max_error)), now - std::min(now - 1, step(now)));
}

const LightSet& LightBudget::choose(const LightSet& all) {
  chosen_ = &all;
  const std::size_t size = all.lights.size();
  if ((!goals_.fps && !goals_.max_error) || size == 0) return all;
  // The dark says nothing of how many lights the next light needs.
  const bool dark = std::none_of(all.lights.begin(), all.lights.end(),
                                 [](const auto& light) { return (light.illuminance > 0).any(); });
  if (dark) return all;
  lacks_prediction_ =
      goals_.max_error && std::all_of(all.lights.begin(), all.lights.end(),
                                      [](const auto& light) { return !(light.predicted_error > 0); });
  if (goals_.max_error && !lacks_prediction_)
    count_ = needed(all, count_);
  else
    count_ = size;
  Quality quality{static_cast<double>(count_), 1};
  const auto error = [&](const Quality& q) {
    return std::hypot(light_error(all, q.lights), map_error(q.texels, goals_.shadow_size));
  };
  if (control_) quality = control_->choose(quality.lights, error);
  texels_ = quality.texels;
  expected_error_ = error(quality);
  if (quality.lights < static_cast<double>(size)) {
    folded_ = fade_lights(all, quality.lights);
    chosen_ = &folded_;
  }
  return *chosen_;
}

}  // namespace lightwell::render
