// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"

namespace lightwell::cli {

// `lightwell field …`: one file a subcommand.
Command add_field_build(CLI::App& field);
Command add_field_live(CLI::App& field);
Command add_field_query(CLI::App& field);

Command add_field(CLI::App& app) {
  CLI::App* group = app.add_subcommand("field", "Light that changes from place to place, from many probes");
  group->require_subcommand(1);
  const std::vector<Command> commands = {add_field_build(*group), add_field_live(*group),
                                         add_field_query(*group)};
  return {group, [commands] {
            for (const Command& command : commands)
              if (command.app->parsed()) return command.run();
            return static_cast<int>(ErrorKind::usage);
          }};
}

}  // namespace lightwell::cli
