// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// lightwell-sync-simulator: the sync board's own firmware in a simulated world, at the other end of a serial line.

#include <signal.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <thread>

#include "firmware/app/app.h"
#include "firmware/port/simulator/link.h"
#include "firmware/port/simulator/simulator.h"

namespace {

using namespace lightwell::sync_simulator;

std::atomic<bool> stop{false};

struct Options {
  WorldOptions world;
  std::vector<std::string> lamps;
  double seconds = 0;  // 0: until stopped
  bool stdio = false, fast = false;
};

Lamp parse_lamp(const std::string& text) {
  Lamp lamp{};
  char rest = 0;
  if (std::sscanf(text.c_str(), "%lf:%lf%c", &lamp.hz, &lamp.depth, &rest) != 2 ||
      !(lamp.hz > 0 && lamp.hz < 1e5) || !(lamp.depth >= 0 && lamp.depth <= 1))
    throw CLI::ValidationError("--lamp", text + " is not HZ:DEPTH with HZ above 0 and DEPTH 0 to 1");
  return lamp;
}

void add_options(CLI::App& app, Options& o) {
  WorldOptions& w = o.world;
  app.add_flag("--stdio", o.stdio,
               "Speak on standard input and output (default: a pseudo-terminal, whose path is printed)");
  app.add_flag("--fast", o.fast, "Virtual time as fast as it goes (default: as fast as the clock)");
  app.add_option("--seconds", o.seconds, "Virtual seconds to run; 0: until stopped")
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
  app.add_option("--reference-stops", w.reference_stops_s, "Second at which it is unplugged")
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
  app.add_option("--lamp", o.lamps, "HZ:DEPTH of a flickering lamp; may be repeated (default 100:0.2)");
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
  app.footer(
      "Example: lightwell-sync-simulator --reference-hz 1 --reference-ppm 40 --lamp 100:0.3 --lamp 730:0.05");
}

void run(const Options& options) {
  Link link = options.stdio ? Link::standard() : Link::terminal();
  if (!options.stdio) {
    std::printf("%s\n", link.path().c_str());
    std::fflush(stdout);
  }
  Simulator simulator(options.world);
  app_start();
  const auto begin = std::chrono::steady_clock::now();
  constexpr int kBatch = World::kSampleHz / 1000;  // a millisecond
  while (!stop && (options.seconds == 0 || simulator.world.seconds() < options.seconds)) {
    if (!link.move(simulator.from_host, simulator.to_host)) return;
    if (options.fast &&
        !simulator.to_host.empty()) {  // a host that is slower than virtual time holds it back
      std::this_thread::sleep_for(std::chrono::microseconds(100));
      continue;
    }
    for (int i = 0; i < kBatch; ++i) {
      simulator.world.step();
      app_poll();
    }
    if (!options.fast)
      std::this_thread::sleep_until(begin + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                std::chrono::duration<double>(simulator.world.seconds())));
  }
  link.move(simulator.from_host, simulator.to_host);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("The sync board's firmware in a simulated world, on a serial line");
  Options options;
  add_options(app, options);
  try {
    app.parse(argc, argv);
    for (const std::string& text : options.lamps) options.world.lamps.push_back(parse_lamp(text));
    if (options.lamps.empty()) options.world.lamps = {{100, 0.2}};
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  struct sigaction action {};
  action.sa_handler = [](int) { stop = true; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  signal(SIGPIPE, SIG_IGN);
  try {
    run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "lightwell-sync-simulator: %s\n", error.what());
    return 1;
  }
  return 0;
}
