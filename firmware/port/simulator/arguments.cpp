// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/port/simulator/arguments.h"

#include <cstdio>
#include <string>
#include <vector>

namespace lightwell::sync_simulator {
namespace {

Lamp parse_lamp(const std::string& text) {
  Lamp lamp{};
  char rest = 0;
  if (std::sscanf(text.c_str(), "%lf:%lf%c", &lamp.hz, &lamp.depth, &rest) != 2 ||
      !(lamp.hz > 0 && lamp.hz < 1e5) || !(lamp.depth >= 0 && lamp.depth <= 1))
    throw CLI::ValidationError("--lamp", text + " is not HZ:DEPTH with HZ above 0 and DEPTH 0 to 1");
  return lamp;
}

}  // namespace

void add_arguments(CLI::App& app, WorldOptions& w, double& seconds) {
  app.add_option("--seconds", seconds, "Virtual seconds to run; 0: until stopped")
      ->check(CLI::Range(0.0, 1e9));
  app.add_option("--drift-ppm", w.drift_ppm, "The board's crystal against true time")
      ->check(CLI::Range(-1000.0, 1000.0));
  app.add_option("--jitter-ns", w.jitter_ns, "Standard deviation of captured edges")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  app.add_option("--reference-hz", w.reference_hz, "Edges of a PPS (1) or genlock; 0: none")
      ->check(CLI::Range(0.0, 240.0));
  app.add_option("--reference-ppm", w.reference_ppm, "The reference against true time")
      ->check(CLI::Range(-1000.0, 1000.0));
  app.add_option("--timecode-hz", w.timecode_hz,
                 "Frames a second of a timecode (LTC), as 25 or 29.97002997; 0: none")
      ->check(CLI::Range(0.0, 30.0));
  app.add_option("--timecode-start", w.timecode_start_s, "Seconds since midnight that it begins with")
      ->check(CLI::Range(0, 86399))
      ->capture_default_str();
  app.add_option("--reference-stops", w.reference_stops_s, "Second at which both are unplugged")
      ->check(CLI::Range(0.0, 1e9));
  app.add_option("--camera-delay-us", w.camera_delay_us, "Trigger to exposure")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  app.add_option("--exposure-us", w.exposure_us, "Length of the strobe")
      ->check(CLI::Range(1.0, 1e6))
      ->capture_default_str();
  app.add_option("--lost-triggers", w.lost_triggers, "Part that the camera misses")
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--lost-strobes", w.lost_strobes, "Part that is not seen")->check(CLI::Range(0.0, 1.0));
  app.add_option("--level-lux", w.level_lux, "Mean light on the photodiode")
      ->check(CLI::Range(0.0, 4095.0))
      ->capture_default_str();
  w.lamps = {{100, 0.2}};
  app.add_option_function<std::vector<std::string>>(
      "--lamp",
      [&w](const std::vector<std::string>& texts) {
        w.lamps.clear();
        for (const std::string& text : texts) w.lamps.push_back(parse_lamp(text));
      },
      "HZ:DEPTH of a flickering lamp; may be repeated (default 100:0.2)");
  app.add_option("--noise", w.noise, "Of the photodiode, relative")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--tilt-deg", w.tilt_deg, "Of the board about its x axis")->check(CLI::Range(-180.0, 180.0));
  app.add_option("--shake", w.shake, "Acceleration along x, m/s² at 2 Hz")->check(CLI::Range(0.0, 100.0));
  app.add_option("--temperature-c", w.temperature_c, "Of the surroundings")
      ->check(CLI::Range(-40.0, 85.0))
      ->capture_default_str();
  app.add_option("--press-every", w.press_every_s, "Seconds between presses of the button; 0: never")
      ->check(CLI::Range(0.0, 1e9));
  app.add_option("--seed", w.seed, "Of everything random")->capture_default_str();
}

}  // namespace lightwell::sync_simulator
