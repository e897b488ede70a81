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
// explain is a step, not flicker: the whole of it goes into the level at once, and the filter learns anew. A lamp
// that went dark gets its swing back with its light (lamps keep their phase on the mains).
//
// Only a swing that is confirmed is taken out: it has foretold as many frames as there are unknowns after it was
// learnt from as many, so that one frame that lies out cannot make one. That is six frames after a new lamp where
// one harmonic is followed, ten where two are. Until then what was confirmed before the step serves, for twice
// that time at most; without it, and where the light jumps more often, everything passes as it is. So do harmonics
// that fold to slower than 64 frames a period (100 Hz at 25 or 50 frames a second is no flicker at all). An odd
// frame or a switched lamp, at any time, costs at most that the swing stays in.
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
  static constexpr int kWindow = 32;  // frames over which a swing is confirmed, at most

  FlickerFilter(std::size_t powers, const FlickerOptions& options);
  void make_gains(double depth);
  // Of a power: its level, and two parts of each harmonic.
  [[nodiscard]] std::size_t unknowns() const { return 1 + 2 * order_.size(); }
  // A power's filter.
  struct Follower {
    // Since the last jump: what is being learnt, and once confirmed is what the filter takes out.
    float level = 0;
    std::array<float, kHarmonics> swing{}, quadrature{};  // z_k, real and imaginary
    // What was last confirmed: z_k / level of the source at phase 0, at any exposure.
    std::array<float, kHarmonics> kept_swing{}, kept_quadrature{};
    float kept_level = 0;
    float noise = 0;  // of an innovation: a running quantile
    float scale = 0;  // of the last jump, fading
    // Running sums since the unknowns were learnt: of |swing foretold|, |innovation|, and −innovation along the swing.
    float foretold_swing = 0, missed = 0, against = 0;
    std::uint8_t age = 0;
    std::uint8_t foretold = 0;  // frames in the sums
    std::uint8_t serves = 0;    // frames for which the kept swing is taken out until the new one is confirmed
    bool confirmed = false;     // the swing has foretold as many frames as there are unknowns
  };
  void follow(Follower& f, float& power) const noexcept;
  bool keep(Follower& f) const noexcept;  // whether it is dark beside what is kept
  void jump(Follower& f, float power, float innovation) const noexcept;
  void confirm(Follower& f, float swing, float innovation) const noexcept;
  [[nodiscard]] float kept_swing(const Follower& f) const noexcept;
  void turn(double seconds, double exposure_s) noexcept;

  FlickerOptions options_;
  std::vector<int> order_;  // harmonics followed: 1, 2
  std::vector<double> frequency_hz_;
  std::array<std::array<float, kStates>, kAges> gains_{};
  std::array<float, kAges> innovation_{};  // expected square, of a jump of 1
  // Of this frame: the turn since the last one, with the change of exposure in it, and the phase since the start.
  std::array<float, kHarmonics> turn_cos_{}, turn_sin_{};
  std::array<float, kHarmonics> phase_cos_{}, phase_sin_{};  // times what the exposure leaves of a swing
  std::array<float, kHarmonics> keep_cos_{}, keep_sin_{};    // over it
  std::vector<Follower> followers_;
  bool started_ = false;
  double start_s_ = 0, last_s_ = 0, last_exposure_s_ = 0;
};

// Which of 100 and 120 Hz the powers of successive frames swing with: the one that explains more of their
// variance about a straight line, where that is more than half; none where neither does, where both fold to the
// same frequency or to nearly none. powers: at least 16 frames
std::optional<double> detect_flicker_hz(std::span<const double> powers, double rate_hz);

}  // namespace lightwell
