// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lighting/decomposition/best/placed_lights.h"
#include "lighting/decomposition/light_powers.h"

namespace lightwell {

// What the last frame's lights showed wrongly: its lights with their powers, and its atoms with their sign turned. Fed
// back, it spreads what changes when a light leaves over the frames that follow. Weights are shares of a frame's
// luminance. Allocates nothing after construction.
class ErrorMemory {
 public:
  ErrorMemory(int lights, int atoms, int stride);

  [[nodiscard]] bool empty() const { return !kept_; }
  void forget() noexcept { kept_ = false; }

  // The frame as it is shown: all its atoms and their moments, and the map's potential at the lights.
  struct Frame {
    const Atoms& atoms;
    const MomentMatrix& atom_moments;
    const PlacedLights& lights;
    const LightPowers& powers;  // their matrix
    const ChannelRows& power;
    const ChannelRows& map_potential;
  };
  void keep(const Frame& frame) noexcept;
  // In shares of another frame's luminance; light that went out takes its error with it.
  void scale_to(const Atoms& atoms) noexcept;
  // Light i came to another place.
  void look_from(const PlacedLights& lights, int i) noexcept;
  // The error's potential at the lights.
  [[nodiscard]] const ChannelRows& at_lights() const { return potential_; }

 private:
  bool kept_ = false;
  Atoms error_;
  MomentMatrix moments_ = MomentMatrix::Zero();
  Rgbd total_ = Rgbd::Zero();  // that frame's illuminance
  double scale_ = 0;
  ChannelRows potential_;
};

}  // namespace lightwell
