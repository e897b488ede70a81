// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "interface/http_client.h"
#include "tests/support/child_process.h"
#include "tests/support/eventually.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)
using nlohmann::json;
using Words = std::vector<std::string>;

// lightwelld with simulated light, and the board's own firmware in a simulated world on a pseudo-terminal.
class DaemonAndBoard : public ::testing::Test {
 protected:
  static std::string program(const std::string& name) { return std::string(LIGHTWELL_BIN_DIR) + "/" + name; }

  // Returns the terminal's path.
  std::string start_board(Words options) {
    options.insert(options.begin(), program("lightwell-sync-simulator"));
    ChildProcess::Options output;
    output.stdout_file = folder_.path() / "terminal.txt";
    std::filesystem::remove(output.stdout_file);
    board_ = std::make_unique<ChildProcess>(options, folder_.path() / "board.log", output);
    std::string path;
    EXPECT_TRUE(eventually([&] {
      std::ifstream(output.stdout_file) >> path;
      return path.find("/dev/") == 0 || !board_->running();
    })) << board_->stderr_text();
    return path;
  }
  void start_daemon(const std::string& board_section) {
    std::ofstream(folder_.path() / "lightwell.toml")
        << "[http]\nlisten = \"127.0.0.1:0\"\n[dds]\ndomain = " << 1 + getpid() % 200 << "\n[board]\n"
        << board_section;
    daemon_ = std::make_unique<ChildProcess>(
        Words{program("lightwelld"), "--config", (folder_.path() / "lightwell.toml").string(), "--source",
              "simulated:static", "--record-dir", folder_.path().string()},
        folder_.path() / "daemon.log");
    const auto url = daemon_->wait_for_line("page: http://");
    ASSERT_TRUE(url) << daemon_->stderr_text();
    http_ = url->substr(0, url->find('/'));
  }
  [[nodiscard]] json status() const {
    HttpRequest request;
    request.path = "/api/v1/status";
    const auto answer = http_request(http_, request);
    return answer ? json::parse(answer->body, nullptr, false) : json();
  }
  [[nodiscard]] json board() const {
    const json all = status();
    return all.is_object() ? all["board"] : json();
  }
  [[nodiscard]] std::string metrics() const {
    HttpRequest request;
    request.path = "/metrics";
    const auto answer = http_request(http_, request);
    return answer ? answer->body : std::string();
  }

  TemporaryFolder folder_;
  std::unique_ptr<ChildProcess> board_, daemon_;
  std::string http_;
};

TEST_F(DaemonAndBoard, WhatTheBoardMeasuresIsInTheStatus) {
  const std::string terminal =
      start_board({"--lamp", "100:0.3", "--level-lux", "800", "--temperature-c", "31", "--drift-ppm", "30"});
  start_daemon("address = \"serial:" + terminal + "\"\ntrigger_rate = \"30000/1001\"\n");
  ASSERT_TRUE(eventually([&] {
    const json b = board();
    return b.is_object() && b["state"] == "connected" && b["trigger"].is_object() &&
           b["flicker"].is_object() && !b["flicker"]["lamps"].empty() && b["temperature_c"].is_number() &&
           b["trigger"]["strobes"] > 60 && b["up_m_s2"].is_array();
  })) << status().dump(1)
      << daemon_->stderr_text();
  const json b = board();
  EXPECT_NEAR(b["flicker"]["lamps"][0]["frequency_hz"].get<double>(), 100, 0.3);
  EXPECT_NEAR(b["flicker"]["lamps"][0]["depth"].get<double>(), 0.3, 0.03);
  EXPECT_NEAR(b["flicker"]["level_lx"].get<double>(), 800, 40);
  EXPECT_LT(b["clock_bound_us"].get<double>(), 5000);
  const json up = b["up_m_s2"];
  EXPECT_NEAR(std::hypot(up[0].get<double>(), up[1].get<double>(), up[2].get<double>()), 9.81, 0.3);
  EXPECT_EQ(b["refused"], "");
  EXPECT_EQ(b["stamped_frames"], 0) << "no board triggers a simulation";
  EXPECT_EQ(status()["alarm"], "");
  EXPECT_NE(metrics().find("lightwell_board_connected 1"), std::string::npos);
}

TEST_F(DaemonAndBoard, ABoardThatDiesIsAnAlarmAndItsReturnEndsIt) {
  // A name that stays, as a udev rule gives.
  const auto link = folder_.path() / "board";
  std::filesystem::create_symlink(start_board({}), link);
  start_daemon("address = \"serial:" + link.string() + "\"\n");
  ASSERT_TRUE(eventually([&] { return board().is_object() && board()["state"] == "connected"; })) << status();
  board_->send(SIGKILL);
  ASSERT_TRUE(eventually([&] {
    return status()["alarm"].get<std::string>().find("Sync board: no device") == 0;
  })) << status();
  std::filesystem::remove(link);
  std::filesystem::create_symlink(start_board({}), link);
  EXPECT_TRUE(eventually([&] { return board()["state"] == "connected" && status()["alarm"] == ""; }))
      << status();
  EXPECT_EQ(board()["reconnects"], 1);
}

TEST_F(DaemonAndBoard, TheRecordButtonBeginsATakeAndEndsIt) {
  const std::string terminal = start_board({"--press-every", "3"});
  start_daemon("address = \"serial:" + terminal + "\"\n");
  ASSERT_TRUE(eventually([&] { return status()["recording"]["active"] == true; })) << status();
  ASSERT_TRUE(eventually([&] { return status()["recording"]["active"] == false; })) << status();
  const json recording = status()["recording"];
  EXPECT_EQ(recording["error"], "");
  EXPECT_GT(recording["frames"].get<int>(), 5);
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / recording["file"].get<std::string>()));
}

TEST_F(DaemonAndBoard, ASettingThatIsNoneIsRefusedAtTheStart) {
  for (const char* section : {"address = \"ttyACM0\"\n", "address = \"usb\"\ntrigger_rate = \"25.5\"\n",
                              "address = \"usb\"\ntrigger_rate = \"25\"\nreference_rate = \"1/0\"\n"}) {
    std::ofstream(folder_.path() / "lightwell.toml") << "[board]\n" << section;
    const ProcessResult checked =
        run_process(program("lightwelld"), {"--config", (folder_.path() / "lightwell.toml").string(),
                                            "--source", "simulated:static", "--check"});
    EXPECT_EQ(checked.exit_code, 2) << checked.err;
    EXPECT_NE(checked.err.find("allowed"), std::string::npos) << checked.err;
  }
}

}  // namespace
}  // namespace lightwell
