// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/port/simulator/world.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lightwell::sync_simulator {

namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kStandard = 9.80665;
constexpr double kLuxACode = 1;           // settings' default scale: 10^6 microlux
constexpr double kStartOfCamera_s = 0.5;  // until it answers after power
constexpr double kWarming_s = 600;

}  // namespace

World::World(const WorldOptions& options) : options_(options), random_(options.seed) {
  if (options.timecode_hz > 0) timecode_.emplace(options.timecode_hz, options.timecode_start_s);
}

std::uint64_t World::tick_of(double true_s) const {
  return static_cast<std::uint64_t>(true_s * kTickHz * (1 + options_.drift_ppm * 1e-6));
}

void World::capture(board_input input, double true_s) {
  const double jitter = options_.jitter_ns * 1e-9 * normal_(random_);
  edges.push_back({input, static_cast<std::uint32_t>(tick_of(std::max(0.0, true_s + jitter)))});
}

void World::pulse(std::uint32_t rise, std::uint32_t) {
  waiting_.push_back({rise, static_cast<std::int32_t>(rise - ticks()) <= 0});
}

bool World::pulse_done(bool* made) {
  if (done_.empty()) return false;
  *made = done_.front();
  done_.pop_front();
  return true;
}

void World::forget_pulses() {
  waiting_.clear();
  done_.clear();
}

// The camera exposes a while after the trigger's edge, unless it has no power, is starting, or loses this one.
void World::answer(double true_s) {
  if (!camera_on_ || true_s < camera_ready_s_ || uniform_(random_) < options_.lost_triggers ||
      uniform_(random_) < options_.lost_strobes)
    return;
  const double begin = true_s + options_.camera_delay_us * 1e-6;
  coming_.push_back({begin, BOARD_STROBE_RISE});
  coming_.push_back({begin + options_.exposure_us * 1e-6, BOARD_STROBE_FALL});
}

void World::make_pulses() {
  const std::uint32_t now = ticks();
  while (!waiting_.empty() &&
         (waiting_.front().late || static_cast<std::int32_t>(waiting_.front().rise - now) <= 0)) {
    const Pulse pulse = waiting_.front();
    waiting_.pop_front();
    done_.push_back(!pulse.late);
    if (pulse.late) continue;
    const double ago = static_cast<double>(now - pulse.rise) / (kTickHz * (1 + options_.drift_ppm * 1e-6));
    answer(seconds() - ago);
  }
  while (!coming_.empty() && coming_.front().true_s <= seconds()) {
    capture(coming_.front().input, coming_.front().true_s);
    coming_.pop_front();
  }
}

void World::feed_reference() {
  if (options_.reference_hz <= 0) return;
  const double period = 1 / (options_.reference_hz * (1 + options_.reference_ppm * 1e-6));
  for (double at = 0.1 + static_cast<double>(next_reference_) * period; at <= seconds();
       at = 0.1 + static_cast<double>(++next_reference_) * period)
    if (at < options_.reference_stops_s) capture(BOARD_REFERENCE, at);
}

void World::feed_timecode() {
  if (!timecode_) return;
  const double slower = 1 / (1 + options_.reference_ppm * 1e-6);
  for (double at = timecode_->next() * slower; at <= seconds(); at = timecode_->next() * slower) {
    if (at < options_.reference_stops_s) capture(BOARD_TIMECODE, at);
    timecode_->advance();
  }
}

void World::feed_sensors() {
  const double now = seconds();
  double light = 1 + options_.noise * normal_(random_);
  for (const Lamp& lamp : options_.lamps) light += lamp.depth * std::cos(kTurn * lamp.hz * now);
  samples.push_back(
      static_cast<std::uint16_t>(std::clamp(options_.level_lux / kLuxACode * light, 0.0, 4095.0)));

  if (now * kImuHz >= static_cast<double>(next_imu_)) {
    ++next_imu_;
    const double tilt = options_.tilt_deg * std::numbers::pi / 180;
    const double push = options_.shake * std::sin(kTurn * 2 * now);
    const auto noisy = [&](double value, double sigma) {
      return static_cast<float>(value + sigma * normal_(random_));
    };
    inertial.push_back({{noisy(push, 0.02), noisy(kStandard * std::sin(tilt), 0.02),
                         noisy(kStandard * std::cos(tilt), 0.02)},
                        {noisy(0.01, 0.002), noisy(-0.005, 0.002), noisy(0.002, 0.002)},
                        ticks()});
  }
  if (now * 4 >= static_cast<double>(next_temperature_)) {
    ++next_temperature_;
    const double warm = options_.temperature_c + options_.warms_c * (1 - std::exp(-now / kWarming_s));
    temperatures.push_back(static_cast<std::int32_t>(std::lround(1000 * (warm + 0.05 * normal_(random_)))));
  }
  pressed = options_.press_every_s > 0 && now > options_.press_every_s &&
            std::fmod(now, options_.press_every_s) < 0.2;
}

void World::step() {
  ++steps_;
  if (!camera_on_) camera_ready_s_ = seconds() + kStartOfCamera_s;
  make_pulses();
  feed_reference();
  feed_timecode();
  feed_sensors();
}

}  // namespace lightwell::sync_simulator
