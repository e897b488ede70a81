// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "interface/http_client.h"
#include "interface/recording.h"
#include "lighting/vector.h"
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
  void start_daemon(const std::string& board_section, const std::string& source = "simulated:static") {
    std::ofstream(folder_.path() / "lightwell.toml")
        << "[http]\nlisten = \"127.0.0.1:0\"\n[dds]\ndomain = " << 1 + getpid() % 200 << "\n[board]\n"
        << board_section;
    daemon_ = std::make_unique<ChildProcess>(
        Words{program("lightwelld"), "--config", (folder_.path() / "lightwell.toml").string(), "--source",
              source, "--record-dir", folder_.path().string()},
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
  [[nodiscard]] json lights() const {
    HttpRequest request;
    request.path = "/api/v1/lights";
    const auto answer = http_request(http_, request);
    return answer ? json::parse(answer->body, nullptr, false) : json();
  }
  // Of the strongest light.
  [[nodiscard]] Vec3d strongest() const {
    Vec3d direction = Vec3d::Zero();
    double most = 0;
    const json now = lights();
    if (!now.is_object() || !now.contains("lights")) return direction;  // no frame yet
    for (const json& light : now["lights"]) {
      const double power = light["illuminance"][1];
      const auto d = light["direction"].get<std::array<double, 3>>();
      if (power > most) most = power, direction = Vec3d(d[0], d[1], d[2]);
    }
    return direction;
  }
  // A take of more than so many frames.
  void record(const std::string& file, int frames) const {
    HttpRequest request;
    request.method = "POST";
    request.path = "/api/v1/record";
    request.body = json{{"action", "start"}, {"file", file}}.dump();
    const auto started = http_request(http_, request);
    ASSERT_TRUE(started && started->status == 200);
    ASSERT_TRUE(eventually([&] { return status()["recording"]["frames"] > frames; })) << status();
    request.body = json{{"action", "stop"}}.dump();
    const auto stopped = http_request(http_, request);
    ASSERT_TRUE(stopped && stopped->status == 200);
  }
  [[nodiscard]] std::string metrics() const {
    HttpRequest request;
    request.path = "/metrics";
    const auto answer = http_request(http_, request);
    return answer ? answer->body : std::string();
  }

  static std::int64_t count(const Timecode& t) {
    return ((t.hours * 60 + t.minutes) * 60 + t.seconds) * 25 + t.frames;
  }

  TemporaryFolder folder_;
  std::unique_ptr<ChildProcess> board_, daemon_;
  std::string http_;
};

TEST_F(DaemonAndBoard, WhatTheBoardMeasuresIsInTheStatus) {
  const std::string terminal =
      start_board({"--lamp", "100:0.3", "--level-lux", "1660", "--temperature-c", "31", "--drift-ppm", "30"});
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
  EXPECT_NEAR(b["flicker"]["level_lx"].get<double>(), 1660, 80);
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

TEST_F(DaemonAndBoard, FramesCarryTheTimecodeAndSoDoesTheTake) {
  const std::string terminal = start_board({"--timecode-hz", "25", "--timecode-start", "36000"});
  start_daemon("address = \"serial:" + terminal + "\"\nreference = \"timecode\"\nreference_rate = \"25\"\n" +
               "trigger_rate = \"25\"\n");
  ASSERT_TRUE(eventually([&] { return lights().is_object() && lights()["timecode"].is_string(); }))
      << status();
  const auto first = parse_timecode(lights()["timecode"].get<std::string>());
  ASSERT_TRUE(first);
  EXPECT_EQ(first->hours, 10);
  EXPECT_TRUE(eventually([&] { return board()["trigger"]["lock"] == "locked"; })) << board();
  ASSERT_NO_FATAL_FAILURE(record("coded.mkv", 30));
  const auto take = RecordingReader::open(folder_.path() / "coded.mkv");
  ASSERT_TRUE(take);
  std::optional<RecordedFrame> first_frame, before;
  int frames = 0, steady = 0;
  std::int64_t steps = 0;
  while (const auto frame = (*take)->skip()) {
    if (!*frame) break;
    ASSERT_TRUE((*frame)->timecode);
    if (before) {
      const std::int64_t step = count(*(*frame)->timecode) - count(*before->timecode);
      steady += step == 0 || step == 1 ? 1 : 0;  // 30 frames of the camera to 25 of the timecode
      steps += step;
    } else {
      first_frame = **frame;
    }
    before = **frame;
    ++frames;
  }
  // The simulated board's clock stands still while its process waits for a busy machine: a border here or there moves,
  // the count does not.
  ASSERT_TRUE(first_frame);
  const double apart_s = static_cast<double>(before->capture_mono_ns - first_frame->capture_mono_ns) * 1e-9;
  EXPECT_NEAR(static_cast<double>(steps), 25 * apart_s, 3);
  EXPECT_GT(steady, frames * 3 / 4);
  EXPECT_GT(frames, 30);
}

TEST_F(DaemonAndBoard, GravityTurnsTheWorldUpright) {
  const std::string terminal = start_board({"--tilt-deg", "12"});
  start_daemon("address = \"serial:" + terminal + "\"\n");
  ASSERT_TRUE(eventually([&] { return board().is_object() && board()["up_m_s2"].is_array(); })) << status();
  ASSERT_TRUE(eventually([&] { return strongest().norm() > 0; })) << status();
  const Vec3d flat = strongest();
  EXPECT_EQ(board()["tilt_deg"], 0) << "nobody has said how the board sits";
  daemon_->send(SIGTERM);
  daemon_->wait();
  start_daemon("address = \"serial:" + terminal + "\"\naxes = \"x,y,z\"\n");
  ASSERT_TRUE(eventually([&] { return board().is_object() && board()["tilt_deg"] > 11; })) << status();
  EXPECT_NEAR(board()["tilt_deg"].get<double>(), 12, 0.5);
  // The camera's y is down in the image: with the zenith leaning that way, what was the zenith leans to azimuth 0 (+Z).
  const double tilt = board()["tilt_deg"].get<double>() * kPi / 180;
  const Vec3d expected(flat.x(), flat.y() * std::cos(tilt) - flat.z() * std::sin(tilt),
                       flat.y() * std::sin(tilt) + flat.z() * std::cos(tilt));
  EXPECT_TRUE(eventually([&] { return strongest().dot(expected) > std::cos(0.02); }))
      << strongest().transpose() << " against " << expected.transpose();
  // A reload of the same keeps the world as it was turned.
  const json calibration = status()["calibration_id"];
  daemon_->send(SIGHUP);
  ASSERT_TRUE(daemon_->wait_for_line("configuration reloaded"));
  EXPECT_EQ(status()["calibration_id"], calibration);
  EXPECT_NEAR(board()["tilt_deg"].get<double>(), 12, 0.5);
}

TEST_F(DaemonAndBoard, LampsMoveTriggerAndExposure) {
  const std::string terminal = start_board({"--lamp", "90:0.3"});
  start_daemon("address = \"serial:" + terminal + "\"\ntrigger_rate = \"25\"\navoid_flicker = true\n");
  ASSERT_TRUE(eventually([&] { return board().is_object() && board()["avoiding"].is_object(); })) << status();
  const json avoiding = board()["avoiding"];
  // A whole number of ripples in an exposure, or of ripples in a frame.
  const double ripples = 90 * avoiding["exposure_us"].get<double>() * 1e-6;
  const double frames = 90 / avoiding["rate_hz"].get<double>();
  EXPECT_TRUE(std::abs(ripples - std::round(ripples)) < 0.01 || std::abs(frames - std::round(frames)) < 0.01)
      << avoiding;
  EXPECT_TRUE(eventually([&] {
    return std::abs(board()["trigger"]["rate_hz"].get<double>() - avoiding["rate_hz"].get<double>()) < 0.01;
  })) << board();
  ASSERT_NO_FATAL_FAILURE(record("avoided.mkv", 2));
  const auto take = RecordingReader::open(folder_.path() / "avoided.mkv");
  ASSERT_TRUE(take);
  EXPECT_NEAR((*(*take)->skip())->exposure_us / avoiding["exposure_us"].get<double>(), 1, 0.02);
  EXPECT_EQ(board()["refused"], "");
}

// The firmware stops triggers after 5 s without a word from its host.
TEST_F(DaemonAndBoard, ADaemonThatWasStoppedForAWhileTriggersAgain) {
  const std::string terminal = start_board({});
  start_daemon("address = \"serial:" + terminal + "\"\ntrigger_rate = \"50\"\n");
  const auto triggers = [&] {
    return board()["trigger"].is_object() ? board()["trigger"]["triggers"].get<int>() : 0;
  };
  ASSERT_TRUE(eventually([&] { return triggers() > 50; })) << status();
  daemon_->send(SIGSTOP);
  std::this_thread::sleep_for(std::chrono::seconds(7));
  daemon_->send(SIGCONT);
  const int before = triggers();
  EXPECT_TRUE(eventually([&] {
    return triggers() > before + 100 && board()["trigger"]["safe_defaults"] == false;
  })) << board();
}

TEST_F(DaemonAndBoard, AReloadThatReadsWhatIsNoCalibrationLeavesTheDaemonAlive) {
  start_daemon("");
  const auto config = folder_.path() / "lightwell.toml";
  std::filesystem::create_directory(folder_.path() / "cal");
  std::ofstream(folder_.path() / "cal" / "flat_notes.json") << "[]";
  std::ofstream(config, std::ios::app)
      << "[calibration]\ndirectory = \"" << (folder_.path() / "cal").string() << "\"\n";
  daemon_->send(SIGHUP);
  ASSERT_TRUE(daemon_->wait_for_line("configuration not reloaded"));
  EXPECT_TRUE(status().is_object());
  EXPECT_TRUE(daemon_->running());
}

TEST_F(DaemonAndBoard, APhotodiodeThatSeesOtherLightThanTheCameraIsAnAlarm) {
  const std::string terminal = start_board({"--level-lux", "400"});
  start_daemon("address = \"serial:" + terminal + "\"\ntrigger_rate = \"25\"\n");
  EXPECT_TRUE(eventually([&] {
    const json now = status();
    return now.is_object() && now["alarm"].get<std::string>().find("Scale: ") == 0;
  })) << status();
  EXPECT_GT(board()["photodiode_check"]["ratio"].get<double>(), 3);
}

TEST_F(DaemonAndBoard, ASettingThatIsNoneIsRefusedAtTheStart) {
  for (const char* section : {"address = \"ttyACM0\"\n", "address = \"usb\"\ntrigger_rate = \"25.5\"\n",
                              "address = \"usb\"\naxes = \"x,y,-z\"\n",
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
