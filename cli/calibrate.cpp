// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"

namespace lightwell::cli {

// `lightwell calibrate …`: one file a subcommand, in the order in which --help lists them.
Command add_calibrate_lens(CLI::App& calibrate);
Command add_calibrate_import(CLI::App& calibrate);
Command add_calibrate_orient(CLI::App& calibrate);
Command add_calibrate_response(CLI::App& calibrate);
Command add_calibrate_chart(CLI::App& calibrate);
Command add_calibrate_flat(CLI::App& calibrate);
Command add_calibrate_verify(CLI::App& calibrate);
Command add_calibrate_brackets(CLI::App& calibrate);
Command add_calibrate_colour(CLI::App& calibrate);
Command add_calibrate_report(CLI::App& calibrate);

Command add_calibrate(CLI::App& app) {
  CLI::App* group = app.add_subcommand("calibrate", "Calibrate a camera's lens and response");
  group->require_subcommand(1);
  const std::vector<Command> commands = {
      add_calibrate_lens(*group),     add_calibrate_import(*group),   add_calibrate_orient(*group),
      add_calibrate_response(*group), add_calibrate_chart(*group),    add_calibrate_flat(*group),
      add_calibrate_verify(*group),   add_calibrate_brackets(*group), add_calibrate_colour(*group),
      add_calibrate_report(*group),
  };
  return {group, [commands] {
            for (const Command& command : commands)
              if (command.app->parsed()) return command.run();
            return static_cast<int>(ErrorKind::usage);
          }};
}

}  // namespace lightwell::cli
