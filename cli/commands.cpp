// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "cli/command.h"
#include "interface/printable.h"

namespace lightwell::cli {

int fail(const Error& error) {
  std::fprintf(stderr, "lightwell: %s\n", printable(error.message).c_str());
  return static_cast<int>(error.kind);
}

Error usage(std::string message) {
  return {ErrorKind::usage, std::move(message)};
}

// One a file, in the order in which --help lists them.
Command add_bench(CLI::App& app);
Command add_board(CLI::App& app);
Command add_calibrate(CLI::App& app);
Command add_devices(CLI::App& app);
Command add_doctor(CLI::App& app);
Command add_evaluate(CLI::App& app);
Command add_filter(CLI::App& app);
Command add_develop(CLI::App& app);
Command add_field(CLI::App& app);
Command add_luminaire(CLI::App& app);
Command add_fit(CLI::App& app);
Command add_play(CLI::App& app);
Command add_lights(CLI::App& app);
Command add_info(CLI::App& app);
Command add_record(CLI::App& app);
Command add_repair(CLI::App& app);
Command add_status(CLI::App& app);

std::vector<Command> add_commands(CLI::App& app) {
  return {
      add_lights(app),    add_evaluate(app), add_fit(app),   add_develop(app),   add_field(app),
      add_luminaire(app), add_bench(app),    add_board(app), add_calibrate(app), add_devices(app),
      add_doctor(app),    add_filter(app),   add_play(app),  add_info(app),      add_record(app),
      add_repair(app),    add_status(app),
  };
}

}  // namespace lightwell::cli
