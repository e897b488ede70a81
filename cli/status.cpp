// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "cli/command.h"
#include "interface/http_client.h"

namespace lightwell::cli {

std::string status_table(const std::string& status_json);
Command add_status(CLI::App& app);

namespace {

using nlohmann::json;
using namespace std::chrono_literals;

constexpr auto kWatchInterval = 1s;

struct Options {
  std::string daemon = "127.0.0.1:8650";
  bool watch = false;
  bool as_json = false;
};

// null: not known yet.
std::string number(const json& value, int digits) {
  if (!value.is_number()) return "-";
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, value.get<double>());
  return text;
}

std::string text(const json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

std::string quantiles(const json& value) {
  return "p50 " + number(value.value("p50", json()), 2) + " ms, p99 " +
         number(value.value("p99", json()), 2) + " ms";
}

std::string recording(const json& value) {
  const std::string counts = number(value.at("frames"), 0) + " frames, " +
                             number(value.at("bytes").get<double>() / 1e6, 1) + " MB, " +
                             number(value.at("dropped"), 0) + " dropped";
  if (value.at("active").get<bool>()) return text(value.at("file")) + ", " + counts;
  if (const std::string error = text(value.at("error")); !error.empty()) return "stopped by itself: " + error;
  return "no";
}

// The daemon's status as JSON; what answers but is no daemon is bad input.
Result<std::string> ask(const std::string& daemon) {
  auto response = http_request(daemon, {.path = "/api/v1/status", .timeout = 3s});
  if (!response) {
    if (response.error().kind == ErrorKind::usage)
      return Error{ErrorKind::usage, "--daemon: " + response.error().message};
    return Error{ErrorKind::failed,
                 "no daemon answers at " + daemon + " (start lightwelld, or give --daemon ADDRESS:PORT)"};
  }
  const json status = json::parse(response->body, nullptr, false);
  if (response->status != 200 || !status.is_object() || !status.contains("source_state"))
    return Error{ErrorKind::bad_input, daemon + ": what answers is not a Lightwell daemon (HTTP " +
                                           std::to_string(response->status) + ")"};
  return std::move(response->body);
}

int run(const Options& options) {
  for (;;) {
    const auto status = ask(options.daemon);
    if (!status) return fail(status.error());
    const std::string shown = options.as_json ? *status : status_table(*status);
    // A watched table stays in place on a terminal.
    if (options.watch && !options.as_json && ::isatty(STDOUT_FILENO) == 1)
      std::fputs("\x1b[H\x1b[2J", stdout);
    if (std::fputs(shown.c_str(), stdout) < 0 || std::fflush(stdout) != 0)
      return fail({ErrorKind::failed, "cannot write to standard output"});
    if (!options.watch) return 0;
    std::this_thread::sleep_for(kWatchInterval);
  }
}

}  // namespace

// One line a fact, and the alarm last, where the eye ends.
std::string status_table(const std::string& status_json) {
  const json s = json::parse(status_json);
  std::string table;
  const auto row = [&](const char* key, const std::string& value) {
    char line[32];
    std::snprintf(line, sizeof line, "%-12s ", key);
    table += line + value + "\n";
  };
  const json& capture = s.at("capture");
  row("source", text(s.at("source")) + ", " + text(s.at("source_state")));
  if (const auto what = text(s.at("source_description")); !what.empty()) row("", what);
  row("rate", number(s.at("measured_rate_hz"), 2) + " Hz of " + number(s.at("nominal_rate_hz"), 2) + " Hz");
  row("frames", number(s.at("published"), 0) + " published, " + number(capture.at("lost"), 0) + " lost, " +
                    number(capture.at("incomplete"), 0) + " incomplete, " + number(capture.at("skipped"), 0) +
                    " skipped, " + number(s.at("dropped_by_pipeline"), 0) + " dropped");
  row("last frame", number(s.at("frame_age_ms"), 0) + " ms ago");
  row("develop", quantiles(s.at("develop_ms")));
  row("lights", quantiles(s.at("lights_ms")));
  row("latency", quantiles(s.at("latency_ms")));
  const std::string verdict = text(s.at("calibration_verdict"));
  row("calibration", text(s.at("calibration_id")) + (verdict.empty() ? "" : ": " + verdict));
  if (const json board = s.value("board", json()); board.is_object() && board.value("state", "off") != "off")
    row("sync board", text(board.at("state")) + ": " + text(board.at("description")));
  row("recording", recording(s.at("recording")));
  row("up", number(s.at("uptime_s"), 0) + " s, version " + text(s.at("version")));
  const std::string alarm = text(s.at("alarm"));
  row("alarm", alarm.empty() ? "none" : alarm);
  return table;
}

Command add_status(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("status", "What the daemon does now");
  command->footer("Example: lightwell status --watch");
  command->add_flag("--watch", options->watch,
                    "Again every second, until Ctrl-C or until the daemon is gone");
  command->add_flag("--json", options->as_json, "The daemon's own JSON, one line each time");
  command->add_option("--daemon", options->daemon, "ADDRESS:PORT of the daemon")->capture_default_str();
  return {command, [options] { return run(*options); }};
}

}  // namespace lightwell::cli
