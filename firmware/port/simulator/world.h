// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// What surrounds a simulated sync board, in virtual time: its own crystal, a camera that answers triggers with strobes, a
// reference, timecode, lamps over a photodiode, gravity, heat, a finger on the button. Everything random has one seed.

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <random>
#include <vector>

#include "firmware/hal/hal.h"
#include "firmware/port/simulator/timecode_source.h"

namespace lightwell::sync_simulator {

struct Lamp {
  double hz, depth;
};

struct WorldOptions {
  double drift_ppm = 0;     // the board's crystal against true time
  double jitter_ns = 200;   // standard deviation of a captured edge
  double reference_hz = 0;  // 0: none
  double reference_ppm = 0;
  double reference_stops_s = 1e300;  // the plug is pulled, of the timecode too
  double timecode_hz = 0;            // frames a second of LTC; 0: none
  int timecode_start_s = 3600;       // since midnight
  double camera_delay_us = 30;
  double exposure_us = 4000;
  double lost_triggers = 0, lost_strobes = 0;  // of all, 0 to 1
  double level_lux = 500;
  std::vector<Lamp> lamps;
  double noise = 0.005;  // of the photodiode, relative
  double tilt_deg = 0;   // of the board, about its x axis
  double shake = 0;      // m/s², 2 Hz
  double temperature_c = 25,
         warms_c = 15;       // surroundings, and by how much the board warms itself (10 minutes)
  double press_every_s = 0;  // the button, for 0.2 s; 0: never
  unsigned seed = 1;
};

class World {
 public:
  static constexpr std::uint32_t kTickHz = 84'000'000;
  static constexpr std::uint32_t kSampleHz = 8000;
  static constexpr std::uint32_t kImuHz = 208;

  explicit World(const WorldOptions& options);

  // True time goes on by a sample of the photodiode, 125 µs.
  void step();
  double seconds() const { return static_cast<double>(steps_) / kSampleHz; }

  // What the port asks of it.
  std::uint32_t ticks() const { return static_cast<std::uint32_t>(tick_of(seconds())); }
  void pulse(std::uint32_t rise, std::uint32_t fall);
  bool pulse_done(bool* made);
  void forget_pulses();
  void camera_power(bool on) { camera_on_ = on; }

  std::deque<hal_edge_event> edges;
  std::deque<std::uint16_t> samples;
  struct Inertial {
    std::array<float, 3> acceleration, rate;
    std::uint32_t stamp;
  };
  std::deque<Inertial> inertial;
  std::deque<std::int32_t> temperatures;
  bool pressed = false;

 private:
  std::uint64_t tick_of(double true_s) const;
  void make_pulses();
  void answer(double true_s);
  void feed_reference();
  void feed_timecode();
  void feed_sensors();
  void capture(board_input input, double true_s);

  WorldOptions options_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_;
  std::uint64_t steps_ = 0;
  bool camera_on_ = false;
  double camera_ready_s_ = 0;
  struct Pulse {
    std::uint32_t rise;
    bool late;
  };
  std::deque<Pulse> waiting_;
  std::deque<bool> done_;
  struct Edge {
    double true_s;
    board_input input;
  };
  std::optional<TimecodeSource> timecode_;
  std::deque<Edge> coming_;  // of the strobe line, in order
  std::uint64_t next_reference_ = 0, next_imu_ = 0, next_temperature_ = 0;
};

}  // namespace lightwell::sync_simulator
