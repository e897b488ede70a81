// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "daemon/configuration.h"
#include "daemon/diagnosis.h"

namespace lightwell::cli {
namespace {

struct Options {
  DiagnosisOptions diagnosis;
  std::string config;
  bool json = false;
};

void print(const std::vector<Finding>& findings) {
  for (const Finding& finding : findings) {
    std::printf("%-4s  %-14s  %s\n", name(finding.verdict), finding.name.c_str(), finding.message.c_str());
    if (!finding.fix.empty()) std::printf("%22s→ %s\n", "", finding.fix.c_str());
  }
}

void print_json(const std::vector<Finding>& findings, bool healthy) {
  auto checks = nlohmann::json::array();
  for (const Finding& finding : findings) {
    checks.push_back({{"name", finding.name},
                      {"verdict", name(finding.verdict)},
                      {"message", finding.message},
                      {"fix", finding.fix}});
  }
  // Messages quote what cameras say of themselves, in any encoding.
  constexpr auto kReplace = nlohmann::json::error_handler_t::replace;
  std::printf("%s\n",
              nlohmann::json{{"ok", healthy}, {"checks", checks}}.dump(2, ' ', false, kReplace).c_str());
}

int run(const CLI::App& command, Options options) {
  if (!options.config.empty()) {
    const auto loaded = load_configuration(options.config, {});
    if (!loaded) return fail(loaded.error());
    const Configuration& configuration = loaded->configuration;
    if (command.count("--http") == 0) options.diagnosis.http = configuration.http.listen;
    if (command.count("--record-dir") == 0)
      options.diagnosis.record_directory = configuration.record.directory;
  }
  const auto findings = diagnose(options.diagnosis);
  if (!findings) return fail(findings.error());
  const bool healthy = std::none_of(findings->begin(), findings->end(),
                                    [](const Finding& finding) { return finding.verdict == Verdict::fail; });
  if (options.json)
    print_json(*findings, healthy);
  else
    print(*findings);
  return healthy ? 0 : static_cast<int>(ErrorKind::failed);
}

}  // namespace

Command add_doctor(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("doctor", "What is wrong on this machine, and how to fix it");
  command
      ->add_option("--config", options->config,
                   "The daemon's configuration, for its address and record folder")
      ->type_name("FILE");
  command->add_option("--http", options->diagnosis.http, "Where the daemon should answer")
      ->type_name("ADDRESS:PORT")
      ->capture_default_str();
  command->add_option("--record-dir", options->diagnosis.record_directory, "Where takes should go")
      ->type_name("DIR")
      ->capture_default_str();
  command->add_flag("--json", options->json, "Machine-readable result on stdout");
  command->footer("Example: lightwell doctor --config lightwell.toml\nExit code 1 where a check failed.");
  return {command, [command, options] { return run(*command, *options); }};
}

}  // namespace lightwell::cli
