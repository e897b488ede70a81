// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// lightwell-sync-simulator: the sync board's own firmware in a simulated world, at the other end of a serial line.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "firmware/port/simulator/arguments.h"
#include "firmware/port/simulator/run.h"
#include "firmware/port/simulator/stream_link.h"

int main(int argc, char** argv) {
  using namespace lightwell::sync_simulator;
  CLI::App app("The sync board's firmware in a simulated world, on a serial line");
  WorldOptions world;
  Pace pace;
  bool stdio = false;
  app.add_flag("--stdio", stdio,
               "Speak on standard input and output (default: a pseudo-terminal, whose path is printed)");
  app.add_flag("--fast", pace.fast, "Virtual time as fast as it goes (default: as fast as the clock)");
  add_arguments(app, world, pace.seconds);
  app.footer(
      "Example: lightwell-sync-simulator --reference-hz 1 --reference-ppm 40 --lamp 100:0.3 --lamp 730:0.05");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    const auto link = stdio ? StreamLink::standard() : StreamLink::terminal();
    if (!stdio) {
      std::printf("%s\n", link->path().c_str());
      std::fflush(stdout);
    }
    Simulator simulator(world);
    run(simulator, *link, pace);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "lightwell-sync-simulator: %s\n", error.what());
    return 1;
  }
  return 0;
}
