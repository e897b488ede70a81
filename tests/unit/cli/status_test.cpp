// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "daemon/web/json.h"
#include "daemon/web/server.h"
#include "tests/support/fake_daemon.h"

namespace lightwell::cli {

std::string status_table(const std::string& status_json);
Command add_status(CLI::App& app);

namespace {

using testing::HasSubstr;

struct Outcome {
  int code = 0;
  std::string out, err;
};

Outcome run_status(const std::vector<std::string>& arguments) {
  CLI::App app;
  const Command command = add_status(app);
  std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
  reversed.emplace_back("status");
  app.parse(reversed);
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  Outcome outcome;
  outcome.code = command.run();
  outcome.out = testing::internal::GetCapturedStdout();
  outcome.err = testing::internal::GetCapturedStderr();
  return outcome;
}

TEST(StatusCommand, TableNamesWhatMatters) {
  DaemonStatus status;
  status.source = "aravis:127.0.0.1";
  status.source_state = SourceState::stalled;
  status.capture.lost = 17;
  status.latency_ms_p50 = std::nan("");
  status.latency_ms_p99 = 1.234;
  status.recording = {.active = true, .file = "a.mkv", .frames = 5, .bytes = 2'000'000, .error = {}};
  status.alarm = "frames do not arrive";
  const std::string table = status_table(status_json(status));
  EXPECT_THAT(table, HasSubstr("aravis:127.0.0.1, " + std::string(name(SourceState::stalled))));
  EXPECT_THAT(table, HasSubstr("17 lost"));
  EXPECT_THAT(table, HasSubstr("p50 - ms, p99 1.23 ms"));
  EXPECT_THAT(table, HasSubstr("a.mkv, 5 frames, 2.0 MB, 0 dropped"));
  EXPECT_THAT(table, testing::EndsWith("frames do not arrive\n"));
}

TEST(StatusCommand, AsksARunningDaemon) {
  SnapshotChannel channel(test::snapshot_shape());
  test::FakeControl control;
  control.change([](DaemonStatus& status) { status.source = "simulated:day"; });
  const auto server = WebServer::start({.listen = "127.0.0.1:0"}, channel, control).value();
  const std::string address = "127.0.0.1:" + std::to_string(server->port());
  const auto table = run_status({"--daemon", address});
  EXPECT_EQ(table.code, 0) << table.err;
  EXPECT_THAT(table.out, HasSubstr("simulated:day"));
  const auto as_json = run_status({"--json", "--daemon", address});
  EXPECT_EQ(as_json.code, 0);
  EXPECT_EQ(nlohmann::json::parse(as_json.out)["source"], "simulated:day");
}

TEST(StatusCommand, NoDaemonIsExitOneWithOneLine) {
  std::string address;
  {
    SnapshotChannel channel(test::snapshot_shape());
    test::FakeControl control;
    const auto gone = WebServer::start({.listen = "127.0.0.1:0"}, channel, control).value();
    address = "127.0.0.1:" + std::to_string(gone->port());
  }
  const auto outcome = run_status({"--daemon", address});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(outcome.err, HasSubstr("no daemon answers at " + address));
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1);
}

TEST(StatusCommand, MalformedAddressIsUsage) {
  const auto outcome = run_status({"--daemon", "nonsense"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("nonsense"));
}

}  // namespace
}  // namespace lightwell::cli
