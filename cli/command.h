// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "lighting/result.h"

namespace lightwell::cli {

// A subcommand adds itself to the application: options, help with an example, and what runs when it is chosen.
// The callback returns the exit code; an Error goes through fail().
using Run = std::function<int()>;
struct Command {
  CLI::App* app = nullptr;
  Run run;
};

// Prints the error's one line to stderr, returns its exit code.
int fail(const Error& error);
// An Error of kind usage.
Error usage(std::string message);

// One function a file: cli/lights.cpp defines add_lights, and so on. add_commands in cli/commands.cpp lists them.
std::vector<Command> add_commands(CLI::App& app);

}  // namespace lightwell::cli
