// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "cli/command.h"

namespace lightwell::cli {

Command add_filter(CLI::App& app);
Command add_status(CLI::App& app);

int fail(const Error& error) {
  std::fprintf(stderr, "lightwell: %s\n", error.message.c_str());
  return static_cast<int>(error.kind);
}

Error usage(std::string message) { return {ErrorKind::usage, std::move(message)}; }

std::vector<Command> add_commands(CLI::App& app) {
  std::vector<Command> commands;
  commands.push_back(add_filter(app));
  commands.push_back(add_status(app));
  return commands;
}

}  // namespace lightwell::cli
