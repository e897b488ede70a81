// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/temporal/flicker_filter.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>

#include "lighting/vector.h"

namespace lightwell {
namespace {

constexpr double kSlowest = 1.0 / 64;  // periods a frame; slower is the light's own
// Noise of a power and wandering of level and swing a frame, in parts of the jump that the filter learns from:
// their ratios set the settled gains, .17 for the level and .06 for each part of the swing, so that a swing is
// followed within a dozen frames when the mains drift.
constexpr double kNoise = 2e-3;
constexpr double kLevelWander = 0.2 * kNoise;
constexpr double kSwingWander = 0.1 * kNoise;
// Swing of a new lamp in parts of its light: what is expected, not a bound. Small, so that of a steady lamp's
// light hardly any is taken for swing.
constexpr double kDepth = 0.15;
// Beyond six standard deviations is no noise; powers are trusted to 0.3 % at best.
constexpr double kJump = 36;
constexpr float kLeastNoise = 3e-3f;
// A running 68 % quantile of |innovation|: up where beyond, down where within, in balance.
constexpr float kNoiseUp = 1.15f;
constexpr float kNoiseDown = 0.9364f;
// What is not yet learnt is taken in parts of the last jump, and that is forgotten in 16 frames (e^(−1/16) a frame) once
// there were two frames for every unknown, confirmed or not, as the swing of a noisy lamp may never be: after a step of a
// hundred and back, a small lamp is a step again.
constexpr float kScaleDecay = 0.9394f;
constexpr float kLeastScale = 1e-20f;  // before floats become slow to multiply
constexpr float kDark = 0.2f;
constexpr double kAveraged = 0.05;  // of a swing: less than this left by the exposure says nothing about it

double folded(double frequency_hz, double rate_hz) {
  const double turns = frequency_hz / rate_hz;
  return std::abs(turns - std::round(turns));
}

// Mean of a swing over the exposure.
double averaging(double frequency_hz, double exposure_s) {
  const double x = kPi * frequency_hz * exposure_s;
  return std::abs(x) < 1e-6 ? 1 : std::sin(x) / x;
}

}  // namespace

Result<FlickerFilter> FlickerFilter::create(std::size_t powers, const FlickerOptions& options) {
  const auto refuse = [](const char* what, double value, const char* range) {
    return Error{ErrorKind::usage,
                 std::string(what) + " " + std::to_string(value) + " is out of range: " + range};
  };
  if (!(options.rate_hz > 0 && options.rate_hz <= 100000))
    return refuse("rate", options.rate_hz, "above 0 to 100000 Hz");
  if (!(options.flicker_hz > 0 && options.flicker_hz <= 100000))
    return refuse("flicker", options.flicker_hz, "above 0 to 100000 Hz");
  if (!(options.exposure_s >= 0 && options.exposure_s <= 10))
    return refuse("exposure", options.exposure_s, "0 to 10 s");
  return FlickerFilter(powers, options);
}

FlickerFilter::FlickerFilter(std::size_t powers, const FlickerOptions& options)
    : options_(options), followers_(powers) {
  std::vector<double> taken;
  for (std::size_t k = 1; k <= kHarmonics; ++k) {
    const double frequency = static_cast<double>(k) * options.flicker_hz;
    const double fold = folded(frequency, options.rate_hz);
    const bool told = fold > kSlowest && std::none_of(taken.begin(), taken.end(), [&](double other) {
                        return std::abs(other - fold) < kSlowest;
                      });
    if (!told) continue;
    taken.push_back(fold);
    order_.push_back(static_cast<int>(k));
    frequency_hz_.push_back(frequency);
  }
  make_gains(kDepth * std::abs(averaging(options.flicker_hz, options.exposure_s)) + 0.01);
}

void FlickerFilter::make_gains(double depth) {
  const auto states = static_cast<Eigen::Index>(1 + 2 * order_.size());
  Eigen::VectorXd h = Eigen::VectorXd::Zero(states);
  Eigen::VectorXd variance = Eigen::VectorXd::Ones(states);
  Eigen::VectorXd wander = Eigen::VectorXd::Constant(states, kSwingWander * kSwingWander);
  Eigen::MatrixXd turn = Eigen::MatrixXd::Identity(states, states);
  h[0] = 1;
  wander[0] = kLevelWander * kLevelWander;
  for (std::size_t k = 0; k < order_.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(1 + 2 * k);
    const double angle = 2 * kPi * frequency_hz_[k] / options_.rate_hz;
    h[at] = 1;
    variance.segment<2>(at).setConstant(depth * depth / 2);
    turn.block<2, 2>(at, at) << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  }
  Eigen::MatrixXd covariance = variance.asDiagonal();
  for (std::size_t age = 0; age < kAges; ++age) {
    const double innovation = h.dot(covariance * h) + kNoise * kNoise;
    const Eigen::VectorXd gain = covariance * h / innovation;
    innovation_[age] = static_cast<float>(innovation);
    for (Eigen::Index i = 0; i < states; ++i)
      gains_[age][static_cast<std::size_t>(i)] = static_cast<float>(gain[i]);
    covariance -= gain * (h.transpose() * covariance).eval();
    covariance = turn * ((covariance + covariance.transpose()) / 2).eval() * turn.transpose();
    covariance.diagonal() += wander;
  }
}

void FlickerFilter::reset() noexcept {
  started_ = false;
  std::fill(followers_.begin(), followers_.end(), Follower{});
}

void FlickerFilter::turn(double seconds, double exposure_s) noexcept {
  for (std::size_t k = 0; k < order_.size(); ++k) {
    const double before = averaging(frequency_hz_[k], last_exposure_s_);
    const double now = averaging(frequency_hz_[k], exposure_s);
    // Of a swing that was averaged away nothing can be said for the new exposure: it is learnt.
    const double change = exposure_s == last_exposure_s_ ? 1
                          : std::abs(before) > kAveraged
                              ? std::clamp(now / before, -1 / kAveraged, 1 / kAveraged)
                              : 0;
    const double angle = 2 * kPi * std::remainder(frequency_hz_[k] * seconds, 1.0);
    turn_cos_[k] = static_cast<float>(change * std::cos(angle));
    turn_sin_[k] = static_cast<float>(change * std::sin(angle));
    const double phase = 2 * kPi * std::remainder(frequency_hz_[k] * (last_s_ + seconds - start_s_), 1.0);
    phase_cos_[k] = static_cast<float>(now * std::cos(phase));
    phase_sin_[k] = static_cast<float>(now * std::sin(phase));
    const double keep = std::abs(now) > kAveraged ? 1 / now : 0;
    keep_cos_[k] = static_cast<float>(keep * std::cos(phase));
    keep_sin_[k] = static_cast<float>(keep * std::sin(phase));
  }
}

// Remembers a confirmed swing, but not the none of a lamp that is off: that lamp's own is wanted when it is lit again.
bool FlickerFilter::keep(Follower& f) const noexcept {
  const bool dark = f.level < kDark * f.kept_level;
  float size = 0;
  for (std::size_t k = 0; k < order_.size(); ++k) size += std::abs(f.swing[k]) + std::abs(f.quadrature[k]);
  if (!f.confirmed || (dark && size <= 0.01f * f.level)) return dark;
  const float per_level = f.level > 0 ? 1 / f.level : 0;
  for (std::size_t k = 0; k < order_.size(); ++k) {
    f.kept_swing[k] = (f.swing[k] * keep_cos_[k] + f.quadrature[k] * keep_sin_[k]) * per_level;
    f.kept_quadrature[k] = (f.quadrature[k] * keep_cos_[k] - f.swing[k] * keep_sin_[k]) * per_level;
  }
  f.kept_level = std::max(0.0f, f.level);
  return false;
}

// The level has jumped: lamps were switched, one frame lies out, or something moves.
void FlickerFilter::jump(Follower& f, float power, float innovation) const noexcept {
  const bool was_dark = keep(f);
  const auto frames = static_cast<std::uint8_t>(4 * unknowns());
  if (power < kDark * f.kept_level) {
    f.serves = 0;
  } else if (was_dark) {  // lit again, and the swing in parts of the level: power = level · (1 + swing)
    f.kept_level = 1;
    f.kept_level = power / std::max(0.4f, 1 + kept_swing(f));
    f.serves = frames;
  } else if (f.confirmed) {
    f.serves = frames;
  }
  f.level = power;
  for (std::size_t k = 0; k < order_.size(); ++k) {
    const float level = f.serves > 0 ? f.kept_level : 0;
    f.swing[k] = level * (f.kept_swing[k] * phase_cos_[k] - f.kept_quadrature[k] * phase_sin_[k]);
    f.quadrature[k] = level * (f.kept_quadrature[k] * phase_cos_[k] + f.kept_swing[k] * phase_sin_[k]);
    f.level -= f.swing[k];
  }
  f.confirmed = false;
  f.scale = std::abs(innovation);
  f.age = 1;
  f.foretold = 0;
  f.foretold_swing = f.missed = f.against = 0;
}

float FlickerFilter::kept_swing(const Follower& f) const noexcept {
  float swing = 0;
  for (std::size_t k = 0; k < order_.size(); ++k)
    swing += f.kept_swing[k] * phase_cos_[k] - f.kept_quadrature[k] * phase_sin_[k];
  return f.kept_level * swing;
}

// Is the swing there? Of the power's regression on what was foretold: the slope is near 1, and four times its error.
void FlickerFilter::confirm(Follower& f, float swing, float innovation) const noexcept {
  if (f.age <= unknowns()) return;
  if (f.foretold < kWindow) ++f.foretold;
  const auto add = [](float& sum, float value) { sum += value - sum / kWindow; };
  add(f.foretold_swing, std::abs(swing) + kLeastNoise * std::max(0.0f, f.level));
  add(f.missed, std::abs(innovation));
  add(f.against, swing < 0 ? innovation : -innovation);
  f.confirmed = f.foretold >= unknowns() && 4 * f.against <= f.foretold_swing &&
                4 * f.missed <= std::sqrt(static_cast<float>(f.foretold)) * f.foretold_swing;
}

void FlickerFilter::apply(double time_s, double exposure_s, std::span<float> powers) noexcept {
  verify_bug(powers.size() == followers_.size(), "the filter was made for another count of powers");
  if (order_.empty()) return;
  if (started_ && !(time_s > last_s_ && time_s - last_s_ <= 1)) reset();
  if (!started_) {
    start_s_ = last_s_ = time_s;
    last_exposure_s_ = exposure_s;
  }
  started_ = true;
  turn(time_s - last_s_, exposure_s);
  last_s_ = time_s;
  last_exposure_s_ = exposure_s;
  for (std::size_t i = 0; i < powers.size(); ++i) follow(followers_[i], powers[i]);
}

void FlickerFilter::follow(Follower& f, float& power) const noexcept {
  const std::size_t harmonics = order_.size();
  float swing = 0;
  for (std::size_t k = 0; k < harmonics; ++k) {
    const float u = f.swing[k] * turn_cos_[k] - f.quadrature[k] * turn_sin_[k];
    f.quadrature[k] = f.quadrature[k] * turn_cos_[k] + f.swing[k] * turn_sin_[k];
    f.swing[k] = u;
    swing += u;
  }
  const float innovation = power - f.level - swing;
  f.noise = std::max(f.noise, kLeastNoise * f.level);
  const auto squared = [](float v) { return static_cast<double>(v) * static_cast<double>(v); };
  const double expected = squared(f.noise) + squared(f.scale) * static_cast<double>(innovation_[f.age]);
  const float dark = kDark * f.kept_level;
  const bool lit =
      f.level < dark && power >= dark;  // within learning too: from the dark no lamp swings so far
  if (lit || squared(innovation) > kJump * expected) {
    f.noise *= kNoiseUp;
    jump(f, power, innovation);
  } else {
    if (f.age >= 4) f.noise *= std::abs(innovation) > f.noise ? kNoiseUp : kNoiseDown;
    const auto& gain = gains_[f.age];
    f.level += gain[0] * innovation;
    for (std::size_t k = 0; k < harmonics; ++k) {
      f.swing[k] += gain[1 + 2 * k] * innovation;
      f.quadrature[k] += gain[2 + 2 * k] * innovation;
    }
    if (f.age + 1u < kAges) ++f.age;
    if (f.age > 2 * unknowns() && f.scale > f.noise + kLeastScale) f.scale *= kScaleDecay;
    if (!f.confirmed) confirm(f, swing, innovation);
  }
  if (f.confirmed) {
    float out = power;
    for (std::size_t k = 0; k < harmonics; ++k) out -= f.swing[k];
    power = std::max(0.0f, out);
  } else if (f.serves > 0) {
    --f.serves;
    power = std::max(0.0f, power - kept_swing(f));
  }
}

std::optional<double> detect_flicker_hz(std::span<const double> powers, double rate_hz) {
  const double fold100 = folded(100, rate_hz);
  const double fold120 = folded(120, rate_hz);
  if (powers.size() < 16 || std::abs(fold100 - fold120) < kSlowest) return std::nullopt;
  const auto frames = static_cast<Eigen::Index>(powers.size());
  const Eigen::Map<const Eigen::VectorXd> values(powers.data(), frames);
  const double largest = values.cwiseAbs().maxCoeff();
  if (!(largest > 0)) return std::nullopt;
  const Eigen::VectorXd power = values / largest;
  Eigen::MatrixXd basis(frames, 4);  // a straight line, and a swing
  for (Eigen::Index t = 0; t < frames; ++t) {
    basis(t, 0) = 1;
    basis(t, 1) = static_cast<double>(t) / static_cast<double>(frames);
  }
  const auto left_over = [&](Eigen::Index columns) {
    const auto used = basis.leftCols(columns);
    return (power - used * used.colPivHouseholderQr().solve(power)).squaredNorm();
  };
  const double about_line = left_over(2);
  if (!(about_line > 1e-12 * static_cast<double>(frames))) return std::nullopt;  // steady to rounding
  std::optional<double> best;
  double least = about_line / 2;
  for (const double frequency : {100.0, 120.0}) {
    if (folded(frequency, rate_hz) <= kSlowest) continue;
    for (Eigen::Index t = 0; t < frames; ++t) {
      const double angle = 2 * kPi * std::remainder(frequency / rate_hz * static_cast<double>(t), 1.0);
      basis(t, 2) = std::cos(angle);
      basis(t, 3) = std::sin(angle);
    }
    if (const double rest = left_over(4); rest < least) {
      least = rest;
      best = frequency;
    }
  }
  return best;
}

}  // namespace lightwell
