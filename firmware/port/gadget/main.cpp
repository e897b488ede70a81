// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// lightwell-sync-gadget: the sync board's own firmware in a simulated world, as a USB device of this machine.

#include <CLI/CLI.hpp>
#include <array>
#include <chrono>
#include <cstdio>
#include <exception>
#include <string>

#include "firmware/port/gadget/functionfs_link.h"
#include "firmware/port/gadget/gadget.h"
#include "firmware/port/simulator/arguments.h"
#include "firmware/port/simulator/run.h"

namespace {

// The number that HELLO says, as interface/sync_usb.h has it.
std::string serial_of(const board_facts& facts) {
  std::array<char, 25> text{};
  std::snprintf(text.data(), text.size(), "%08x%08x%08x", facts.serial[0], facts.serial[1], facts.serial[2]);
  return text.data();
}

}  // namespace

int main(int argc, char** argv) {
  using namespace lightwell;
  CLI::App app("The sync board's firmware in a simulated world, as a USB device of this machine; needs root");
  sync_simulator::WorldOptions world;
  sync_simulator::Pace pace;
  sync_gadget::GadgetOptions gadget;
  std::string controller;
  double stall_every_s = 0;
  app.add_option("--name", gadget.name, "Of the gadget in configfs; another for each board of a machine")
      ->check([](const std::string& name) {
        return name.empty() || name.find('/') != std::string::npos ? "a name has no slash" : "";
      })
      ->capture_default_str();
  app.add_option("--udc", controller,
                 "USB device controller of /sys/class/udc (default: the first that is free)");
  app.add_flag("--full-speed", gadget.full_speed, "12 Mbit/s (default: as fast as the controller goes)");
  app.add_option("--stall-every", stall_every_s, "Seconds between halts of both endpoints; 0: never")
      ->check(CLI::Range(0.0, 1e6));
  add_arguments(app, world, pace.seconds);
  app.footer("Example: lightwell-sync-gadget --udc dummy_udc.0 --lamp 100:0.3");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    sync_simulator::Simulator simulator(world);
    gadget.serial = serial_of(simulator.facts());
    sync_gadget::Gadget device(gadget);
    sync_gadget::FunctionFsLink link(device.functionfs(),
                                     std::chrono::milliseconds(static_cast<long>(1000 * stall_every_s)));
    const std::string bound = device.bind(controller);
    std::printf("%s on %s\n", gadget.serial.c_str(), bound.c_str());
    std::fflush(stdout);
    run(simulator, link, pace);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "lightwell-sync-gadget: %s\n", error.what());
    return 1;
  }
  return 0;
}
