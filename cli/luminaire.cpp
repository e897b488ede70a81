// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"

namespace lightwell::cli {

// `lightwell luminaire …`: one file a subcommand.
Command add_luminaire_build(CLI::App& luminaire);
Command add_luminaire_export(CLI::App& luminaire);
Command add_luminaire_import(CLI::App& luminaire);
Command add_luminaire_locate(CLI::App& luminaire);
Command add_luminaire_query(CLI::App& luminaire);

Command add_luminaire(CLI::App& app) {
  CLI::App* group = app.add_subcommand("luminaire", "Lamps close to what they light");
  group->require_subcommand(1);
  const std::vector<Command> commands = {add_luminaire_build(*group), add_luminaire_export(*group),
                                         add_luminaire_import(*group), add_luminaire_locate(*group),
                                         add_luminaire_query(*group)};
  return {group, [commands] {
            for (const Command& command : commands)
              if (command.app->parsed()) return command.run();
            return static_cast<int>(ErrorKind::usage);
          }};
}

}  // namespace lightwell::cli
