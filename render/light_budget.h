// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "lighting/light_set.h"
#include "render/quality_control.h"

namespace lightwell::render {

// Of a progressive light set as many lights as the frame time affords, and no more than an error asks for. For the frame
// rate QualityControl chooses them, and the share of the shadow maps' texels; the least urgent lights go first, and the last
// one fades. What an error alone asks for is there at once, and given up by a sixteenth a frame.
class LightBudget {
 public:
  struct Goals {
    std::optional<double> fps;        // frames a second to hold
    std::optional<double> max_error;  // predicted shadow error that the fewest lights are to keep
    int shadow_size = 256;            // texels a side of a map, where all are there
  };
  explicit LightBudget(const Goals& goals);
  LightBudget(const LightBudget&) = delete;  // what is chosen may lie within
  LightBudget& operator=(const LightBudget&) = delete;

  // The lights to draw; the set itself where there is no goal, or it is no set to choose from. Valid until the next call.
  const LightSet& choose(const LightSet& all);
  [[nodiscard]] const LightSet& chosen() const { return *chosen_; }
  // Of the shadow maps' texels, with the lights chosen.
  [[nodiscard]] double texels() const { return texels_; }
  // Relative RMSE that is expected of a picture with them: of too few lights as predicted, else as measured of such
  // numbers, and of the maps' texels.
  [[nodiscard]] double expected_error() const { return expected_error_; }
  // How long the last frame took, with the lights chosen for it, and what share of the shadow maps it drew.
  void frame_took(double ms, double maps_drawn) {
    if (control_) control_->frame_took(ms, maps_drawn);
  }
  // True where an error is asked for of lights that carry no prediction: all are taken.
  [[nodiscard]] bool lacks_prediction() const { return lacks_prediction_; }

 private:
  [[nodiscard]] std::size_t needed(const LightSet& all, std::size_t now) const;

  Goals goals_;
  std::size_t count_ = 0;  // of the last frame; 0: there was none
  std::optional<QualityControl> control_;
  double texels_ = 1;
  double expected_error_ = 0;
  bool lacks_prediction_ = false;
  LightSet folded_;
  const LightSet* chosen_ = &folded_;
};

}  // namespace lightwell::render
