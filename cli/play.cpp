// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <cstdio>
#include <string>
#include <thread>

#include "cli/command.h"
#include "daemon/configuration.h"
#include "daemon/daemon.h"
#include "interface/dds_domain.h"
#include "interface/option_range.h"

namespace lightwell::cli {
namespace {

struct Arguments {
  std::string take;
  double speed = 1;
  bool loop = false;
  std::string calibration;
  std::string listen = "127.0.0.1:8650";
  int domain = 0;
};

volatile std::sig_atomic_t interrupted = 0;

Overrides overrides(const Arguments& a) {
  Overrides given = {{"source.address", "recording:" + a.take},
                     {"source.speed", std::to_string(a.speed)},
                     {"source.loop", a.loop ? "true" : "false"},
                     {"http.listen", a.listen},
                     {"dds.domain", std::to_string(a.domain)}};
  if (!a.calibration.empty()) given.emplace_back("calibration.directory", a.calibration);
  return given;
}

// The daemon itself with the take as its camera: whoever listens to a probe hears the take.
int run(const Arguments& a) {
  const auto loaded = load_configuration("", overrides(a));
  if (!loaded) return fail(loaded.error());
  std::signal(SIGINT, [](int) { interrupted = 1; });
  std::signal(SIGTERM, [](int) { interrupted = 1; });
  auto daemon = Daemon::start(loaded->configuration);
  if (!daemon) return fail(daemon.error());
  std::fprintf(stderr, "playing %s; page: %s\n", a.take.c_str(), (*daemon)->url().c_str());
  while (interrupted == 0 && !(*daemon)->ended()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const DaemonStatus status = (*daemon)->status();
  (*daemon)->stop();
  std::fprintf(stderr, "%llu frames published\n", static_cast<unsigned long long>(status.published));
  if (status.published == 0 && !status.alarm.empty())
    return fail({ErrorKind::bad_input, a.take + ": " + status.alarm});
  return 0;
}

}  // namespace

Command add_play(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("play", "Publish a take's light as the daemon would");
  command->add_option("TAKE", arguments->take, "recording (.mkv)")->required();
  command
      ->add_option("--speed", arguments->speed,
                   "1 as recorded, 0.5 half as fast, 0 as fast as it can, no frame skipped")
      ->check(numbers_from(0, 1000, "0 to 1000"));
  command->add_flag("--loop", arguments->loop, "begin again at the end");
  command->add_option("--calibration", arguments->calibration,
                      "folder to use instead of the take's own calibration");
  command->add_option("--listen", arguments->listen, "ADDRESS:PORT of the page");
  command->add_option("--domain", arguments->domain, "DDS domain")->check(whole_numbers(0, kMaxDdsDomain));
  command->footer("Example: lightwell play take.mkv --loop --speed 0.5");
  return {command, [arguments] { return run(*arguments); }};
}

}  // namespace lightwell::cli
