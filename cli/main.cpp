// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <string>

#include "cli/command.h"
#include "field/launched_ranks.h"

namespace {

// The word where a command should stand, if it is what the command line failed on.
std::string unknown_command(const CLI::App& app) {
  const CLI::App* last = &app;
  while (!last->get_subcommands().empty()) last = last->get_subcommands().front();
  const std::vector<std::string> words = last->remaining();
  return last->get_require_subcommand_min() == 0 || words.empty() ? std::string() : words.front();
}

int run(int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_logger_mt("lightwell"));  // stdout is for results
  CLI::App app{"Lightwell: measure the light on set, relight virtual objects with it", "lightwell"};
  app.require_subcommand(1);
  app.set_version_flag("--version", "lightwell 0.1.0");
  app.failure_message([](const CLI::App*, const CLI::Error& error) {
    return std::string("lightwell: ") + error.what() + "\n";
  });
  const auto commands = lightwell::cli::add_commands(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // Of the ranks of a field's build one says what all see.
    if (app.got_subcommand("field") && lightwell::launched_rank() > 0)
      return error.get_exit_code() == 0 ? 0 : static_cast<int>(lightwell::ErrorKind::usage);
    const std::string word = unknown_command(app);
    if (error.get_exit_code() != 0 && !word.empty())
      return lightwell::cli::fail(
          lightwell::cli::usage("unknown command or option '" + word + "'; --help lists them"));
    return app.exit(error) == 0 ? 0 : static_cast<int>(lightwell::ErrorKind::usage);
  }
  for (const auto& command : commands)
    if (command.app->parsed()) return command.run();
  return static_cast<int>(lightwell::ErrorKind::usage);
}

}  // namespace

// lightwell COMMAND …: parse, run the chosen command, and turn every failure into one line and an exit code.
int main(int argc, char** argv) {
  try {
    const int code = run(argc, argv);
    // A result that was not written whole must not look like one.
    errno = 0;
    if (code == 0 && (std::fflush(stdout) != 0 || std::ferror(stdout) != 0))
      return lightwell::cli::fail(
          {lightwell::ErrorKind::failed,
           std::string("standard output: cannot write") +
               (errno != 0 ? std::string(": ") + std::strerror(errno) : std::string())});
    return code;
  } catch (const std::bad_alloc&) {
    return lightwell::cli::fail({lightwell::ErrorKind::failed, "not enough memory"});
  } catch (const std::exception& error) {
    return lightwell::cli::fail({lightwell::ErrorKind::failed, error.what()});
  }
}
