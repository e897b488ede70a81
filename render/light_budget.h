// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "lighting/light_set.h"

namespace lightwell::render {

// Of a progressive light set as many lights as the frame time affords, and no more than an error asks for. For the frame
// rate their number changes by a sixteenth a frame at the most (but one at the least), the least urgent lights first: so no
// step pops. What an error asks for is there at once, and given up at that pace.
class LightBudget {
 public:
  struct Goals {
    std::optional<double> fps;        // frames a second to hold
    std::optional<double> max_error;  // predicted shadow error that the fewest lights are to keep
  };
  explicit LightBudget(const Goals& goals) : goals_(goals) {}

  // The lights to draw; the set itself where there is no goal, or it is no set to choose from. Valid until the next call.
  const LightSet& choose(const LightSet& all);
  [[nodiscard]] const LightSet& chosen() const { return *chosen_; }
  // How long the last frame took, with the lights chosen for it.
  void frame_took(double ms);
  // True where an error is asked for of lights that carry no prediction: all are taken.
  [[nodiscard]] bool lacks_prediction() const { return lacks_prediction_; }

 private:
  [[nodiscard]] std::size_t affordable(std::size_t now, std::size_t all) const;
  [[nodiscard]] std::size_t needed(const LightSet& all, std::size_t now) const;

  Goals goals_;
  std::size_t count_ = 0;  // of the last frame; 0: there was none
  std::array<double, 5> ms_{};
  int frames_ = 0;  // whose time is known, with the lights as they are
  bool lacks_prediction_ = false;
  LightSet folded_;
  const LightSet* chosen_ = &folded_;
};

}  // namespace lightwell::render
