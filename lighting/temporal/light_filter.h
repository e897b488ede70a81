// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "lighting/sampling/light_arrays.h"
#include "lighting/vector.h"

namespace lightwell {

// A finite impulse response over every light's direction and power, frame after frame.
// source: Havran et al. 2005, section 3.3
//
// Directions are filtered as vectors and made unit again. A sum shorter than 0.05 has no direction worth the
// name (opposite directions in the window): the light keeps the direction it had. A direction below the map's
// edge, where overshoot can carry it, is raised to the edge at its azimuth.
//
// Power is filtered per channel. An equiripple filter has negative taps, so after a step or a spike its
// output leaves the range of its input (a 100× flash would be followed by −11.5): each light is held to the
// least and the largest of its own window, so is the sum over the lights, and the lights are scaled to that
// sum. Hence power is never negative, never exceeds what was seen, a constant total stays exactly constant,
// and slow changes of the total pass as designed.
//
// The first frame fills the history: no fade-in from black. apply allocates nothing and does not fail.
class LightFilter {
 public:
  // taps: newest frame first, of any phase, sum 1; theta_max_rad: edge of the map
  LightFilter(std::span<const double> taps, std::size_t count, double theta_max_rad);

  // Takes this frame's lights, gives the filtered ones. Both of `count` lights;
  // out may not be in.
  void apply(const LightArrays& in, LightArrays& out) noexcept;
  void reset() noexcept;

  // By how much slow changes are late: half of the order where the taps are symmetric.
  [[nodiscard]] double delay_frames() const { return delay_frames_; }

 private:
  void filter_directions(LightArrays& out) noexcept;
  void filter_power(std::size_t channel, std::vector<float>& out) noexcept;
  using Channel = std::vector<float> LightArrays::*;
  // within_range: each light held to the least and the largest of its window
  void filter_channel(Channel channel, bool within_range, std::vector<float>& out) noexcept;
  [[nodiscard]] const LightArrays& frame(std::size_t age) const {
    return history_[(newest_ + history_.size() - age) % history_.size()];
  }

  std::vector<float> taps_;
  double delay_frames_;
  double edge_cosine_;
  double edge_sine_;
  bool filled_ = false;
  std::size_t newest_ = 0;
  std::vector<LightArrays> history_;             // ring of the last frames, one a tap
  std::vector<std::array<double, 3>> totals_;    // of those frames, per channel
  std::vector<float> last_x_, last_y_, last_z_;  // what came out before
  std::vector<const float*> past_;               // scratch: a channel's frames, newest first
};

}  // namespace lightwell
