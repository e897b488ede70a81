// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/light_budget.h"

#include <algorithm>
#include <vector>

#include "lighting/median.h"

namespace lightwell::render {
namespace {

// Between these shares of the frame's time nothing changes.
constexpr double kFull = 0.95, kLoose = 0.75;
// Lights are given up only where the error stays this far below what is allowed: else their number would flutter.
constexpr double kSafe = 0.9;

std::size_t step(std::size_t count) {
  return std::max<std::size_t>(1, count / 16);
}

}  // namespace

// From the median of the last frames: one slow frame is no reason.
std::size_t LightBudget::affordable(std::size_t now, std::size_t all) const {
  if (!goals_.fps || frames_ < 3) return now;
  const auto known = static_cast<std::size_t>(std::min<int>(frames_, static_cast<int>(ms_.size())));
  const double used =
      median(std::vector<double>(ms_.begin(), ms_.begin() + static_cast<std::ptrdiff_t>(known))) *
      *goals_.fps / 1000;
  if (used > kFull) return now - std::min(now - 1, step(now));
  if (used < kLoose) return std::min(all, now + step(now));
  return now;
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
  std::size_t count = affordable(count_ == 0 ? size : std::min(count_, size), size);
  lacks_prediction_ =
      goals_.max_error && std::all_of(all.lights.begin(), all.lights.end(),
                                      [](const auto& light) { return !(light.predicted_error > 0); });
  if (goals_.max_error && !lacks_prediction_) {
    const std::size_t least = needed(all, count_);
    count = goals_.fps ? std::min(count, least) : least;
  }
  if (count != count_) frames_ = 0;
  count_ = count;
  if (count < size) {
    folded_ = take_lights(all, count);
    chosen_ = &folded_;
  }
  return *chosen_;
}

void LightBudget::frame_took(double ms) {
  ms_[static_cast<std::size_t>(frames_) % ms_.size()] = ms;
  ++frames_;
}

}  // namespace lightwell::render
