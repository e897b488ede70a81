// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lighting/result.h"

namespace lightwell {

struct FlickerOptions {
  double flicker_hz = 100;  // of the light: twice the mains' frequency
  double rate_hz = 60;      // frames a second
  double exposure_s = 0;  // of the first frames; 0: short. An exposure of whole periods averages flicker away
};

// Takes the swing of lamps on the mains out of a row of powers (a map's bins, a set's lights, or their total),
// each by itself, and lets everything else through in the same frame: a lamp that is switched, a cloud, a ramp.
//
// A power is a level plus harmonics of the flicker, sampled by the camera and so folded below half of its rate:
// P(t) = c + Re Σ z_k, where z_k turns by 2π k · flicker_hz · Δt a frame. c and z_k are followed by a Kalman
// filter in the turning frame, whose gains depend only on the frames since the level last jumped and are made
// once. What comes out is P − Re Σ z_k: no low-pass, so no lag. An innovation far beyond what noise and learning
// explain is a switched lamp: the whole of it goes into the level at once, the swing stays as it was, and the
// filter learns anew; a source that went dark takes its swing along, and gets it back with its light (lamps keep
// their phase on the mains).
//
// A swing is taken out once it has foretold a frame: four frames after a new lamp where one harmonic is followed,
// six where two are. Until then, and where the light jumps more often than that, everything passes as it is; so do
// harmonics that fold to slower than 64 frames a period (100 Hz at 25 or 50 frames a second is no flicker at all).
// source: Kalman 1960; the turning frame as in adaptive notch filters (Widrow et al. 1975)
class FlickerFilter {
 public:
  // fails (usage): rate or flicker not in (0, 100000] Hz, exposure not in [0, 10] s
  static Result<FlickerFilter> create(std::size_t powers, const FlickerOptions& options);

  // Frame by frame, in place. time_s: mid-exposure, any origin; frames may be missing. Not later than the frame
  // before, or over a second later: starts anew. powers: as many as given to create, finite and ≥ 0; so they come
  // out. Allocates nothing.
  void apply(double time_s, double exposure_s, std::span<float> powers) noexcept;
  void reset() noexcept;

  // Harmonics that are taken out; 0: everything passes as it is.
  [[nodiscard]] std::size_t harmonics() const { return order_.size(); }

 private:
  static constexpr std::size_t kHarmonics =
      2;                                    // further ones are faint in lamps, and averaged by the exposure
  static constexpr std::size_t kAges = 64;  // gains have settled by then
  static constexpr std::size_t kStates = 1 + 2 * kHarmonics;

  FlickerFilter(std::size_t powers, const FlickerOptions& options);
  void make_gains(double depth);
  // As many frames as there are unknowns.
  [[nodiscard]] std::size_t learning_frames() const { return 1 + 2 * order_.size(); }
  // A power's filter.
  struct Follower {
    float level = 0;
    std::array<float, kHarmonics> swing{}, quadrature{};  // z_k, real and imaginary
    std::array<float, kHarmonics> kept_swing{},
        kept_quadrature{};  // z_k / level at phase 0, of when it was lit
    float noise = 0;        // of an innovation: a running quantile
    float scale = 0;        // of the last jump
    std::uint8_t age = 0;
    bool trusted = false;  // the swing has foretold a frame
  };
  void jump(Follower& f, float power, float innovation) const noexcept;
  void turn(double seconds, double exposure_s) noexcept;

  FlickerOptions options_;
  std::vector<int> order_;  // harmonics followed: 1, 2
  std::vector<double> frequency_hz_;
  std::array<std::array<float, kStates>, kAges> gains_{};
  std::array<float, kAges> innovation_{};  // expected square, of a jump of 1
  // Of this frame: the turn since the last one, with the change of exposure in it, and the phase since the start.
  std::array<float, kHarmonics> turn_cos_{}, turn_sin_{};
  std::array<float, kHarmonics> phase_cos_{}, phase_sin_{};
  std::vector<Follower> followers_;
  bool started_ = false;
  double start_s_ = 0, last_s_ = 0, last_exposure_s_ = 0;
};

// Which of 100 and 120 Hz the powers of successive frames swing with: the one that explains more of their
// variance about a straight line, where that is more than half; none where neither does, where both fold to the
// same frequency or to nearly none. powers: at least 16 frames
std::optional<double> detect_flicker_hz(std::span<const double> powers, double rate_hz);

}  // namespace lightwell
