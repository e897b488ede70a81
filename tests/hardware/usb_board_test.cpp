// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// lightwelld with the sync board on USB: what it says is what the page shows, and it may be pulled and put back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "interface/http_client.h"
#include "tests/hardware/usb_gadget.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::test {
namespace {

using nlohmann::json;

class DaemonAndUsbBoard : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists("/sys/class/udc/dummy_udc.0"))
      GTEST_SKIP() << "there is no dummy_udc: run in the virtual machine";
  }
  void start_daemon(const std::string& board_section) {
    const auto file = folder_.path() / "lightwell.toml";
    // Light that an emulated processor works out in good time.
    std::ofstream(file) << "[http]\nlisten = \"127.0.0.1:0\"\n"
                           "[source]\nwidth = 160\nheight = 120\nrate_hz = 2.0\n"
                           "[map]\nrings = 45\nsectors = 180\n[lights]\nsampler = \"standard\"\ncount = 32\n"
                           "filter = \"none\"\nrelaxed = false\n[fit]\nlights = 0\n[board]\n"
                        << board_section;
    daemon_ = std::make_unique<ChildProcess>(
        std::vector<std::string>{LIGHTWELL_BIN_DIR "/lightwelld", "--config", file.string(), "--source",
                                 "simulated:static", "--record-dir", folder_.path().string()},
        folder_.path() / "daemon.log");
    const auto url = daemon_->wait_for_line("page: http://");
    ASSERT_TRUE(url) << daemon_->stderr_text();
    http_ = url->substr(0, url->find('/'));
  }
  [[nodiscard]] std::string get(const std::string& path) const {
    HttpRequest request;
    request.path = path;
    const auto answer = http_request(http_, request);
    return answer ? answer->body : std::string();
  }
  [[nodiscard]] json status() const { return json::parse(get("/api/v1/status"), nullptr, false); }
  [[nodiscard]] json board() const {
    const json all = status();
    return all.is_object() ? all["board"] : json{{"state", ""}};
  }
  [[nodiscard]] bool connected() const { return board()["state"] == "connected"; }

  TemporaryFolder folder_;
  std::unique_ptr<ChildProcess> daemon_;
  std::string http_;
};

TEST_F(DaemonAndUsbBoard, WhatTheBoardSaysIsInTheStatusAndOnThePage) {
  UsbGadget gadget(folder_.path(), 0, 1,
                   {"--lamp", "100:0.3", "--level-lux", "800", "--tilt-deg", "20", "--reference-hz", "25",
                    "--temperature-c", "31"});
  start_daemon("address = \"usb\"\ntrigger_rate = \"25\"\nreference = \"pulse\"\nreference_rate = \"25\"\n");
  ASSERT_TRUE(eventually(
      [&] {
        const json b = board();
        return b["state"] == "connected" && b["trigger"].is_object() && b["trigger"]["lock"] == "locked" &&
               b["trigger"]["strobes"] > 50 && b["flicker"].is_object() && !b["flicker"]["lamps"].empty() &&
               b["up_m_s2"].is_array() && b["temperature_c"].is_number();
      },
      std::chrono::seconds(60)))
      << status().dump(1) << daemon_->stderr_text();
  const json b = board();
  EXPECT_NEAR(b["flicker"]["lamps"][0]["frequency_hz"].get<double>(), 100, 0.3);
  EXPECT_NEAR(b["flicker"]["lamps"][0]["depth"].get<double>(), 0.3, 0.03);
  EXPECT_NEAR(b["flicker"]["level_lx"].get<double>(), 800, 40);
  EXPECT_DOUBLE_EQ(b["trigger"]["rate_hz"].get<double>(), 25);
  const json up = b["up_m_s2"];
  EXPECT_NEAR(std::atan2(up[1].get<double>(), up[2].get<double>()) * 180 / std::acos(-1.0), 20, 1);
  EXPECT_EQ(b["refused"], "");
  EXPECT_THAT(b["description"], testing::HasSubstr(gadget.serial()));
  const std::string metrics = get("/metrics");
  EXPECT_THAT(metrics, testing::HasSubstr("lightwell_board_connected 1"));
  EXPECT_THAT(metrics, testing::HasSubstr("lightwell_board_locked 1"));
  EXPECT_THAT(get("/"), testing::HasSubstr("id=\"board\"")) << "where the page shows it";
}

TEST_F(DaemonAndUsbBoard, ABoardThatIsPulledIsAnAlarmAndItsReturnEndsItAtOnce) {
  using Clock = std::chrono::steady_clock;
  start_daemon("address = \"usb\"\ntrigger_rate = \"25\"\n");
  EXPECT_TRUE(eventually([&] { return board()["description"] == "no sync board on USB"; })) << status();
  const auto seconds_until_connected = [&](Clock::time_point since) {
    EXPECT_TRUE(eventually([&] { return connected(); })) << status();
    return std::chrono::duration<double>(Clock::now() - since).count();
  };
  auto gadget = std::make_unique<UsbGadget>(folder_.path(), 0, 1);
  double longest_s = seconds_until_connected(Clock::now());
  const auto lost = [&] {
    return eventually(
        [&] { return status()["alarm"].get<std::string>().find("Sync board: no device") == 0; });
  };
  gadget->unplug();
  EXPECT_TRUE(lost()) << status();
  gadget->plug();
  longest_s = std::max(longest_s, seconds_until_connected(Clock::now()));
  gadget->process().send(SIGKILL);
  EXPECT_TRUE(lost()) << status();
  gadget = std::make_unique<UsbGadget>(folder_.path(), 0, 2);
  longest_s = std::max(longest_s, seconds_until_connected(Clock::now()));
  EXPECT_EQ(status()["alarm"], "");
  EXPECT_EQ(board()["reconnects"], 2);
  RecordProperty("longest_return_s", std::to_string(longest_s));
  std::printf("[          ] longest return: %.2f s\n", longest_s);
}

}  // namespace
}  // namespace lightwell::test
