// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <optional>

namespace lightwell::render {

// What a frame's time is spent on.
struct Quality {
  double lights = 0;  // a fraction: the last one is fading
  double texels = 1;  // of the shadow maps, as a share of all they may have
};

// Keeps the time of a frame. When it is too long, that is given up which saves the most time for the error it adds; when
// there is room, that is taken which saves the most error for its time. What a step costs is learnt from the frames before
// and after it. Begins with few lights, which any machine affords, and goes to what it chose little by little.
class QualityControl {
 public:
  // The error that is expected of a quality; smaller with more of either.
  using Error = std::function<double(const Quality&)>;

  explicit QualityControl(double fps) : frame_ms_(1000 / fps) {}

  // Of the next frame. most_lights: ≥ 1, how many there are to choose from.
  Quality choose(double most_lights, const Error& error);
  // How long the last frame took, with the quality chosen for it; maps_drawn: share of the shadow maps that it drew. While
  // maps stand their texels cost nothing.
  void frame_took(double ms, double maps_drawn = 1);
  static constexpr std::size_t kKnobs = 2;  // lights, texels
  // What a knob's e-fold is believed to cost, ms; 0: no frame is known yet.
  [[nodiscard]] const std::array<double, kKnobs>& costs_ms() const { return cost_ms_; }

 private:
  struct Step {
    std::size_t knob = 0;
    double logarithm = 0;  // of the knob's value after it over that before
    Quality after;
    double error = 0;  // more or less of it, ≥ 0
  };

  [[nodiscard]] double median_ms() const;
  [[nodiscard]] Step step(std::size_t knob, bool up, double most_lights, double pace,
                          const Error& error) const;
  using Steps = std::array<Step, kKnobs>;
  [[nodiscard]] double time_of(const Step& step) const {
    return cost_ms_[step.knob] * std::abs(step.logarithm) * (step.knob == 1 ? maps_drawn_ : 1);
  }
  [[nodiscard]] std::optional<Step> best(const Steps& steps, bool up, double ms) const;
  [[nodiscard]] std::optional<Step> exchange(const Steps& down, const Steps& up) const;
  void take(const Step& step, double ms);
  void learn(double ms);
  void decide(double most_lights, const Error& error);
  void approach(double most_lights);

  double frame_ms_;
  Quality shown_, wanted_;
  std::array<double, kKnobs> cost_ms_{};  // of a knob's logarithm; 0: not known yet
  Step last_;                             // of no length: nothing to learn
  double ms_before_ = 0;
  double maps_drawn_ = 1;  // share, eased
  std::optional<std::size_t>
      given_;  // the knob that was turned down for the other's sake, while the time fits
  std::array<bool, kKnobs> measured_{};
  std::array<double, 5> ms_{};
  std::size_t frames_ = 0;  // whose time is known, with the quality as it is
};

}  // namespace lightwell::render
