// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The daemon on real drivers: light out of what they send. Vivid, v4l2loopback, vimc through libcamera, a GigE Vision
// camera through Aravis and a recording all go through one pipeline, and lights come out of each.
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "daemon/capture/list_libcamera.h"
#include "daemon/simulator/frame_generator.h"
#include "daemon/simulator/probe_setup.h"
#include "interface/calibration_io.h"
#include "interface/http_client.h"
#include "tests/hardware/loopback_writer.h"
#include "tests/support/child_process.h"
#include "tests/support/eventually.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::test {
namespace {

class DaemonOnDrivers : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists("/dev/video10"))
      GTEST_SKIP() << "there is no /dev/video10: run in the virtual machine";
  }
  simulator::ProbeSetup probe(int width, int height, const std::string& pixel_format = "Mono16") {
    simulator::ProbeOptions options;
    options.scenario = "static";
    options.width = width;
    options.height = height;
    options.pixel_format = pixel_format;
    options.noise_codes = 0;
    auto setup = simulator::set_up_probe(options);
    EXPECT_TRUE(setup.ok());
    EXPECT_TRUE(write_calibration(folder_.path() / "calibration", setup->model.calibration).ok());
    return *std::move(setup);
  }
  // calibrated: by the folder that probe has written; otherwise by what the source brings.
  void start_daemon(const std::string& source, const std::string& settings, bool calibrated = true) {
    const auto file = folder_.path() / "lightwell.toml";
    std::ofstream(file) << "[http]\nlisten = \"127.0.0.1:0\"\n[source]\n"
                        << settings
                        // What an emulated processor works out in good time.
                        << "[map]\nrings = 45\nsectors = 180\n[lights]\nsampler = \"standard\"\ncount = 32\n"
                           "filter = \"none\"\nrelaxed = false\n[fit]\nlights = 0\n";
    std::vector<std::string> words = {
        LIGHTWELL_BIN_DIR "/lightwelld", "--config", file.string(), "--source", source, "--record-dir",
        folder_.path().string()};
    if (calibrated) words.insert(words.end(), {"--calibration", (folder_.path() / "calibration").string()});
    daemon_ = std::make_unique<ChildProcess>(words, folder_.path() / "daemon.log");
    const auto url = daemon_->wait_for_line("page: http://");
    ASSERT_TRUE(url) << daemon_->stderr_text();
    http_ = url->substr(0, url->find('/'));
  }
  nlohmann::json get(const std::string& path) const {
    HttpRequest request;
    request.path = path;
    const auto response = http_request(http_, request);
    if (!response || response->status != 200) return {};
    return nlohmann::json::parse(response->body, nullptr, false);
  }
  bool published_reaches(std::uint64_t count) const {
    return eventually(
        [&] {
          const auto status = get("/api/v1/status");
          return status.is_object() && status.value("published", std::uint64_t{0}) >= count;
        },
        std::chrono::seconds(60));
  }

  // Lights of newly published frames, and an illuminance that is no nothing.
  void expect_lights() {
    ASSERT_TRUE(published_reaches(5)) << daemon_->stderr_text();
    const auto lights = get("/api/v1/lights");
    EXPECT_GT(lights.at("lights").size(), 0U);
    EXPECT_GT(lights.at("total_illuminance").at(1).get<double>(), 0);
    EXPECT_EQ(get("/api/v1/status").value("source_state", ""), "streaming");
  }

  TemporaryFolder folder_;
  std::unique_ptr<ChildProcess> daemon_;
  std::string http_;
};

// What is written into v4l2loopback comes out as the light that was painted: within 1 %, as over GigE Vision.
TEST_F(DaemonOnDrivers, LightOfV4l2LoopbackIsWhatWasWritten) {
  const auto setup = probe(320, 240);
  simulator::FrameGenerator generator(setup.scene, setup.model);
  std::vector<std::byte> picture(setup.model.format.bytes());
  const auto truth = generator.render(1, setup.exposure_us, 0, setup.model.format.pixel_format, picture);
  LoopbackWriter writer("/dev/video21", V4L2_PIX_FMT_Y16, 320, 240);
  writer.run(5, [&](std::uint64_t, std::span<std::byte> frame) {
    std::copy(picture.begin(), picture.end(), frame.begin());
  });
  start_daemon("v4l2:/dev/video21", "exposure_us = " + std::to_string(setup.exposure_us) + "\n");
  ASSERT_TRUE(published_reaches(5)) << daemon_->stderr_text();
  const auto total = get("/api/v1/lights").at("total_illuminance");
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(total.at(static_cast<std::size_t>(c)).get<double>(), truth.total_illuminance[c],
                0.01 * truth.total_illuminance[c]);
}

TEST_F(DaemonOnDrivers, VividGivesLightsAndLosesAndFindsItsCamera) {
  probe(320, 180);
  start_daemon("v4l2:/dev/video10",
               "width = 320\nheight = 180\npixel_format = \"Mono16\"\nrate_hz = 5.0\nexposure_us = 1000.0\n");
  expect_lights();
  std::ofstream("/sys/bus/platform/drivers/vivid/unbind") << "vivid.0" << std::flush;
  EXPECT_TRUE(eventually([&] { return get("/api/v1/status").value("source_state", "") == "no device"; }));
  const std::uint64_t before = get("/api/v1/status").value("published", std::uint64_t{0});
  std::ofstream("/sys/bus/platform/drivers/vivid/bind") << "vivid.0" << std::flush;
  EXPECT_TRUE(published_reaches(before + 5)) << daemon_->stderr_text();
}

#ifdef LIGHTWELL_LIBCAMERA
TEST_F(DaemonOnDrivers, VimcGivesLightsThroughLibcameraAndIsLostAndFound) {
  const auto cameras = list_libcamera();
  if (cameras.empty()) GTEST_SKIP() << "libcamera sees no camera";
  probe(192, 120, "BayerRG8");
  start_daemon("libcamera:" + cameras.front().id, "width = 192\nheight = 120\nexposure_us = 1000.0\n");
  expect_lights();
  std::ofstream("/sys/bus/platform/drivers/vimc/unbind") << "vimc.0" << std::flush;
  EXPECT_TRUE(eventually([&] { return get("/api/v1/status").value("source_state", "") == "no device"; }));
  const std::uint64_t before = get("/api/v1/status").value("published", std::uint64_t{0});
  std::ofstream("/sys/bus/platform/drivers/vimc/bind") << "vimc.0" << std::flush;
  EXPECT_TRUE(published_reaches(before + 5)) << daemon_->stderr_text();
}
#endif

TEST_F(DaemonOnDrivers, GigeVisionCameraGivesLightsThroughAravis) {
  const ChildProcess camera(
      {LIGHTWELL_BIN_DIR "/lightwell-camera", "--address", "127.0.0.1", "--scenario", "static", "--size",
       "320x240", "--rate", "5", "--write-calibration", (folder_.path() / "calibration").string()},
      folder_.path() / "camera.log");
  ASSERT_TRUE(eventually([&] {
    return std::filesystem::exists(folder_.path() / "calibration" / "lens.json");
  })) << camera.stderr_text();
  start_daemon("aravis:127.0.0.1", "");
  expect_lights();
}

TEST_F(DaemonOnDrivers, RecordingGivesLights) {
  start_daemon("recording:" LIGHTWELL_SOURCE_DIR "/tests/data/take.mkv", "loop = true\nspeed = 0.2\n", false);
  expect_lights();
}

}  // namespace
}  // namespace lightwell::test
