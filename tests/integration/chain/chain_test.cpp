// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// From the camera on the wire to published lights, with the programs as they ship.

#include <gmock/gmock.h>

#include <csignal>

#include "interface/atomic_file.h"
#include "interface/environment_io.h"
#include "interface/lens_json.h"
#include "interface/recording.h"
#include "lighting/direction.h"
#include "tests/integration/chain/chain.h"

namespace lightwell::test {
namespace {

using testing::HasSubstr;

void expect_within(const Rgbd& measured, const Rgbd& truth, double relative) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(measured[c], truth[c], relative * truth[c]) << "channel " << c;
}

// The issue's bounds for a scene at rest: 1 % without noise, 2 % with the camera's ordinary noise.
TEST_F(Chain, StaticIlluminanceIsTheCamerasTruth) {
  start_camera({"--scenario", "static", "--size", "640x480", "--rate", "30", "--noise", "0"});
  start_daemon();
  ASSERT_TRUE(published_reaches(20)) << daemon_->stderr_text();
  expect_within(rgb_of(get("/api/v1/lights").at("total_illuminance")),
                rgb_of(last_truth().at("total_illuminance")), 0.01);
}

TEST_F(Chain, StaticIlluminanceInColourWithNoise) {
  start_camera({"--scenario", "static", "--size", "640x480", "--rate", "30", "--pixel-format", "BayerRG12"});
  start_daemon();
  ASSERT_TRUE(published_reaches(20)) << daemon_->stderr_text();
  expect_within(rgb_of(get("/api/v1/lights").at("total_illuminance")),
                rgb_of(last_truth().at("total_illuminance")), 0.02);
}

// Gravity end to end: `calibrate orient` tells the lens, the simulated camera hangs so, the daemon turns its light back.
TEST_F(Chain, ATiltedCamerasSunStandsWhereTheWorldHasIt) {
  const Lens lens{{480, 480}, {112, 112}, {239.5, 239.5}, {0, 0, 0, 0}, 115 * kPi / 180};
  const auto level = folder_.path() / "level.json", tilted = folder_.path() / "tilted.json";
  ASSERT_TRUE(write_file_atomically(level, lens_to_json(lens).dump()));
  const ProcessResult orient =
      run_process(program("lightwell"), {"calibrate", "orient", level.string(), "--gravity", "2.9,-1.7,9.2",
                                         "--out", tilted.string()});  // 20 degrees
  ASSERT_EQ(orient.exit_code, 0) << orient.err;
  // An even sphere and a sun of 3 x 3 pixels: row 35 of 128 is 50 degrees off the zenith, column 191 of 256 in the west.
  LatLongImage sky{256, 128, std::vector<Rgb>(256 * 128, Rgb::Constant(100))};
  for (int y = 34; y <= 36; ++y)
    for (int x = 190; x <= 192; ++x) sky.at(x, y) = Rgb::Constant(3e6f);
  const Vec3d sun = direction_from_lat_long(191.5 / 256, 35.5 / 128);
  const auto map = folder_.path() / "sky.exr";
  ASSERT_TRUE(write_environment(map, sky));
  start_camera({"--environment", map.string(), "--size", "480x480", "--rate", "10", "--noise", "0", "--lens",
                tilted.string()});
  start_daemon();
  ASSERT_TRUE(published_reaches(5)) << daemon_->stderr_text();
  const auto set = get("/api/v1/lights");
  // Pixels on the horizon are taken or left whole: half a degree, as often too many as too few.
  expect_within(rgb_of(set.at("total_illuminance")), rgb_of(last_truth().at("total_illuminance")), 0.02);
  Vec3d toward = Vec3d::Zero();
  double power = 0, all = 0;
  for (const auto& light : set.at("lights")) {
    const auto& d = light.at("direction");
    const Vec3d direction(d.at(0), d.at(1), d.at(2));
    const double weight = luminance(rgb_of(light.at("illuminance")));
    all += weight;
    if (direction.dot(sun) < std::cos(5 * kPi / 180)) continue;
    toward += weight * direction;
    power += weight;
  }
  // The sun's nine pixels have 12 klx, the sky 200 π lux.
  EXPECT_GT(power, 0.9 * all);
  // Half a bin of a degree, half a pixel of half a degree, and the sky's own lights around.
  EXPECT_LT(std::acos(toward.normalized().dot(sun)) * 180 / kPi, 1.0);
}

TEST_F(Chain, LightsSumToTheTotalAndStandAboveTheHorizon) {
  start_camera({"--scenario", "day", "--size", "320x240", "--rate", "30"});
  start_daemon();
  ASSERT_TRUE(published_reaches(30));
  const auto set = get("/api/v1/lights");
  Rgbd sum = Rgbd::Zero();
  for (const auto& light : set.at("lights")) {
    const auto& d = light.at("direction");
    const Vec3d direction(d.at(0), d.at(1), d.at(2));
    EXPECT_NEAR(direction.norm(), 1, 1e-5);
    EXPECT_GE(direction.y(), 0);
    sum += rgb_of(light.at("illuminance"));
  }
  EXPECT_LE(set.at("lights").size(), 72u);
  expect_within(sum, rgb_of(set.at("total_illuminance")),
                1e-4);  // floats written and read exactly; sums of 72
}

TEST_F(Chain, CameraKilledIsSaidAndLightReturnsWithTheCamera) {
  const Words options = {"--scenario", "static", "--size", "320x240", "--rate", "30"};
  start_camera(options);
  start_daemon();
  ASSERT_TRUE(published_reaches(10));
  camera_->send(SIGKILL);
  ASSERT_EQ(camera_->wait_for_end(), -SIGKILL);
  EXPECT_TRUE(eventually([&] { return status().value("alarm", "") != ""; }));
  const std::uint64_t before = published();
  start_camera(options);
  EXPECT_TRUE(published_reaches(before + 20)) << daemon_->stderr_text();
  EXPECT_TRUE(eventually([&] { return status().value("alarm", "x").empty(); })) << status();
  EXPECT_TRUE(daemon_->running());
}

TEST_F(Chain, CameraReplacedByOneOfAnotherSizeIsNamed) {
  start_camera({"--scenario", "static", "--size", "320x240", "--rate", "30"});
  start_daemon();
  ASSERT_TRUE(published_reaches(10));
  camera_->send(SIGTERM);
  ASSERT_EQ(camera_->wait_for_end(), 0);
  Words command = {program("lightwell-camera"),
                   "--address",
                   address_,
                   "--scenario",
                   "static",
                   "--size",
                   "160x120",
                   "--rate",
                   "30"};
  camera_ = std::make_unique<ChildProcess>(command, folder_.path() / "camera.log");
  EXPECT_TRUE(eventually([&] { return status().value("alarm", "").find("160") != std::string::npos; },
                         std::chrono::seconds(60)))
      << status();
  const auto log_says = [&](const char* what) {
    return eventually([&] { return daemon_->stderr_text().find(what) != std::string::npos; },
                      std::chrono::seconds(60));
  };
  EXPECT_TRUE(log_says("error: calibration: does not fit the frames")) << daemon_->stderr_text();
  camera_->send(SIGTERM);
  ASSERT_EQ(camera_->wait_for_end(), 0);
  start_camera({"--scenario", "static", "--size", "320x240", "--rate", "30"});
  EXPECT_TRUE(log_says("info: calibration: fits the frames again")) << daemon_->stderr_text();
}

TEST_F(Chain, DaemonStartedBeforeItsCameraFindsIt) {
  start_camera({"--scenario", "static", "--size", "320x240", "--rate", "30"});  // for the calibration
  camera_->send(SIGTERM);
  ASSERT_EQ(camera_->wait_for_end(), 0);
  start_daemon();
  EXPECT_TRUE(eventually([&] { return status().value("alarm", "") != ""; }));
  start_camera({"--scenario", "static", "--size", "320x240", "--rate", "30"});
  EXPECT_TRUE(published_reaches(10)) << daemon_->stderr_text();
}

TEST_F(Chain, TerminationClosesTheTake) {
  start_camera({"--scenario", "static", "--size", "320x240", "--rate", "30"});
  start_daemon();
  ASSERT_TRUE(published_reaches(5));
  ASSERT_EQ(post("/api/v1/record", R"({"action": "start", "file": "take.mkv"})"), 200);
  ASSERT_TRUE(eventually([&] { return status().at("recording").value("frames", 0) >= 20; })) << status();
  daemon_->send(SIGTERM);
  ASSERT_EQ(daemon_->wait_for_end(), 0) << daemon_->stderr_text();
  auto take = RecordingReader::open(folder_.path() / "take.mkv");
  ASSERT_TRUE(take) << take.error().message;
  EXPECT_TRUE((*take)->complete());
  EXPECT_GE((*take)->frame_count().value(), 20u);
  EXPECT_FALSE((*take)->header().calibration_json.empty());
}

TEST_F(Chain, FullDiskEndsTheTakeAndNotTheLight) {
  start_camera({"--scenario", "static", "--size", "320x240", "--rate", "30"});
  ChildProcess::Options options;
  options.file_bytes = 8'000'000;  // 52 frames, three clusters of half a second
  start_daemon("", options);
  ASSERT_TRUE(published_reaches(5));
  ASSERT_EQ(post("/api/v1/record", R"({"action": "start", "file": "take.mkv"})"), 200);
  ASSERT_TRUE(eventually([&] { return status().value("alarm", "") != ""; })) << status();
  EXPECT_FALSE(status().at("recording").at("active").get<bool>());
  EXPECT_TRUE(published_reaches(published() + 20));
  auto take = RecordingReader::open(folder_.path() / "take.mkv");
  ASSERT_TRUE(take) << take.error().message;
  EXPECT_GE((*take)->frame_count().value(), 15u);  // a cluster at least
}

TEST_F(Chain, ReloadChangesTheLightsWithoutAPause) {
  start_camera({"--scenario", "static", "--size", "320x240", "--rate", "30"});
  start_daemon();
  ASSERT_TRUE(published_reaches(10));
  EXPECT_EQ(get("/api/v1/lights").at("method"), "best");
  write_configuration("[lights]\ncount = 9\nclusters = 0\nsampler = \"standard\"\n");
  daemon_->send(SIGHUP);
  EXPECT_TRUE(eventually([&] { return get("/api/v1/lights").at("lights").size() == 9; }))
      << daemon_->stderr_text();
  EXPECT_EQ(get("/api/v1/lights").at("method"), "standard");
  EXPECT_EQ(status().at("capture").at("reconnects"), 0);
  write_configuration("[lights]\ncount = -1\n");
  daemon_->send(SIGHUP);
  EXPECT_TRUE(daemon_->wait_for_line("not reloaded"));
  EXPECT_TRUE(published_reaches(published() + 10));
  EXPECT_EQ(get("/api/v1/lights").at("lights").size(), 9u);
}

TEST_F(Chain, AmbientAndFewLightsAreFittedBesideTheLightsAndFollowAReload) {
  start_camera({"--scenario", "static", "--size", "320x240", "--rate", "30"});
  start_daemon();
  ASSERT_TRUE(eventually([&] { return get("/api/v1/lights").contains("fit"); })) << daemon_->stderr_text();
  const auto set = get("/api/v1/lights");
  EXPECT_GE(set.at("fit").at("lights").size(), 1u);
  EXPECT_LE(set.at("fit").at("lights").size(), 4u);
  EXPECT_LT(set.at("fit").at("residual").get<double>(), 0.2);
  // What the fit's map shines with is what the harmonics' constant says: Σ L Ω = √(4π) L_00; of other frames of a still
  // scene, with the camera's noise.
  const double constant = set.at("sh").at(0).at(1).get<double>() * std::sqrt(4 * kPi);
  EXPECT_NEAR(set.at("fit").at("total_illuminance").at(1).get<double>() / constant, 1, 0.02);
  write_configuration("[fit]\nlights = 1\n");
  daemon_->send(SIGHUP);
  EXPECT_TRUE(eventually([&] {
    const auto now = get("/api/v1/lights");
    return now.contains("fit") && now.at("fit").at("lights").size() == 1;
  })) << daemon_->stderr_text();
  write_configuration("[fit]\nlights = 0\n");
  daemon_->send(SIGHUP);
  EXPECT_TRUE(eventually([&] { return !get("/api/v1/lights").contains("fit"); })) << daemon_->stderr_text();
}

TEST_F(Chain, RecordedTakeReplaysTheSameLightsBitForBit) {
  start_camera({"--scenario", "studio", "--size", "160x120", "--rate", "30"});
  start_daemon();
  ASSERT_TRUE(published_reaches(5));
  ASSERT_EQ(post("/api/v1/record", R"({"action": "start", "file": "take.mkv"})"), 200);
  ASSERT_TRUE(eventually([&] { return status().at("recording").value("frames", 0) >= 15; }));
  ASSERT_EQ(post("/api/v1/record", R"({"action": "stop"})"), 200);
  daemon_.reset();
  nlohmann::json runs[2];
  for (nlohmann::json& lights : runs) {
    write_configuration("[source]\nspeed = 0\n");
    daemon_ = std::make_unique<ChildProcess>(
        Words{program("lightwelld"), "--config", config_file().string(), "--source",
              "recording:" + (folder_.path() / "take.mkv").string()},
        folder_.path() / "replay.log");
    const auto url = daemon_->wait_for_line("page: http://");
    ASSERT_TRUE(url) << daemon_->stderr_text();
    http_ = url->substr(0, url->find('/'));
    ASSERT_TRUE(eventually([&] { return status().value("source_state", "") == "ended"; })) << status();
    // The source has ended; its last frames may still be on their way to lights.
    ASSERT_TRUE(published_reaches(status().at("capture").at("received").get<std::uint64_t>())) << status();
    lights = get("/api/v1/lights");
    daemon_.reset();
  }
  ASSERT_FALSE(runs[0].at("lights").empty());
  EXPECT_EQ(runs[0].at("lights"), runs[1].at("lights"));
  EXPECT_EQ(runs[0].at("sequence"), runs[1].at("sequence"));
}

// Exit codes and the one line, as a person at the terminal meets them.
class DaemonCommandLine : public Chain {
 protected:
  int run(const Words& options) {
    Words command = {program("lightwelld")};
    command.insert(command.end(), options.begin(), options.end());
    ChildProcess process(command, folder_.path() / "daemon.log");
    const int code = process.wait_for_end().value_or(-1000);
    text_ = process.stderr_text();
    EXPECT_EQ(std::count(text_.begin(), text_.end(), '\n'), 1) << text_;
    return code;
  }
  std::string text_;
};

TEST_F(DaemonCommandLine, BadInputIsOneLineAndItsExitCode) {
  EXPECT_EQ(run({"--source", "carrier-pigeon:7"}), 2);
  EXPECT_THAT(text_, HasSubstr("carrier-pigeon"));
  EXPECT_EQ(run({"--source", "aravis:127.0.0.1"}), 2);
  EXPECT_THAT(text_, HasSubstr("--calibration"));
  EXPECT_EQ(run({"--source", "aravis:127.0.0.1", "--calibration", "/nonexistent"}), 3);
  EXPECT_EQ(run({"--source", "recording:/nonexistent.mkv", "--check"}), 3);
  EXPECT_EQ(run({"--config", "/nonexistent.toml"}), 3);
  EXPECT_EQ(run({"--record-dir", "/nonexistent", "--source", "simulated:static"}), 1);
  std::ofstream(config_file()) << "[http]\nlisten = \"0.0.0.0:8650\"\n";
  EXPECT_EQ(run({"--config", config_file().string(), "--source", "simulated:static", "--check"}), 2);
  EXPECT_THAT(text_, HasSubstr("0.0.0.0"));
  EXPECT_THAT(text_, HasSubstr("token"));
}

TEST_F(DaemonCommandLine, CheckRefusesWhatTheStartRefuses) {
  std::ofstream(config_file()) << "[dds]\ninterface = \"nosuch0\"\n";
  const Words options = {"--config",     config_file().string(),  "--source", "simulated:static",
                         "--record-dir", folder_.path().string(), "--check"};
  EXPECT_EQ(run(options), 2);
  EXPECT_THAT(text_, HasSubstr("nosuch0"));
}

TEST_F(DaemonCommandLine, CheckRefusesFramesThatTheCalibrationDoesNotFit) {
  start_camera({"--scenario", "static", "--size", "320x240", "--rate", "30"});  // for its calibration
  Words options = {"--config",         config_file().string(),  "--source",
                   "simulated:static", "--calibration",         calibration().string(),
                   "--record-dir",     folder_.path().string(), "--check"};
  std::ofstream(config_file()) << "[source]\nwidth = 160\nheight = 120\n";
  EXPECT_EQ(run(options), 3);
  EXPECT_THAT(text_, HasSubstr("frame width"));
  EXPECT_THAT(text_, HasSubstr("160"));
  EXPECT_THAT(text_, HasSubstr("320"));
  std::ofstream(config_file()) << "[source]\nwidth = 320\nheight = 240\n";
  EXPECT_EQ(run(options), 0) << text_;
}

TEST_F(DaemonCommandLine, CheckAcceptsWhatIsGood) {
  EXPECT_EQ(run({"--source", "simulated:static", "--record-dir", folder_.path().string(), "--check"}), 0);
}

}  // namespace
}  // namespace lightwell::test
