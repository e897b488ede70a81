// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>

#include "interface/atomic_file.h"
#include "interface/exr_file.h"
#include "interface/light_set_io.h"
#include "render/egl_context.h"
#include "render/picture.h"
#include "render/plate.h"
#include "tests/integration/render/program.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_scene.h"

namespace lightwell {
namespace {

using test::ChildProcess;
using test::start_render;

class Viewing : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto context = render::EglContext::create();
    if (!context) GTEST_SKIP() << context.error().message;
    ASSERT_TRUE(write_light_set(lights_, test::light_set({{Vec3f(1, 2, 1), Rgb::Constant(1000)}})));
  }
  [[nodiscard]] std::string file(const std::string& name) const { return (folder_.path() / name).string(); }
  [[nodiscard]] ChildProcess start(std::vector<std::string> more) const {
    std::vector<std::string> all = {"--scene",    LIGHTWELL_STAGE, "--light-set", lights_,
                                    "--headless", "--shadow-size", "64"};
    all.insert(all.end(), more.begin(), more.end());
    return start_render(folder_.path(), all);
  }
  [[nodiscard]] LatLongImage exr(const std::string& name) const {
    const auto bytes = read_text_file(file(name));
    EXPECT_TRUE(bytes.ok());
    auto image = read_exr(*bytes, name, 1 << 20);
    EXPECT_TRUE(image.ok());
    return *image;
  }
  void expect_refused(const std::vector<std::string>& more, int exit_code, const std::string& named) const {
    ChildProcess program = start(more);
    EXPECT_EQ(program.wait(), exit_code) << named;
    const std::string errors = program.stderr_text();
    EXPECT_NE(errors.find(named), std::string::npos) << errors;
    EXPECT_EQ(std::count(errors.begin(), errors.end(), '\n'), 1) << errors;
  }

  test::TemporaryFolder folder_;
  std::string lights_ = (folder_.path() / "lights.json").string();
};

TEST_F(Viewing, FramesLieOverTheirPlatesInThePlatesSize) {
  for (int i = 0; i < 2; ++i) {
    std::vector<float> rgba;
    for (int k = 0; k < 40 * 30; ++k) rgba.insert(rgba.end(), {5.0f + static_cast<float>(i), 1, 1, 1});
    ASSERT_TRUE(render::write_exr(file("plate_" + std::to_string(i) + ".exr"), {40, 30, rgba}));
  }
  ChildProcess program = start({"--background", file("plate_%d.exr"), "--plate-white", "3", "--frames", "2",
                                "--out", file("f_%d.exr")});
  ASSERT_EQ(program.wait(), 0) << program.stderr_text();
  EXPECT_EQ(program.stderr_text(), "");
  for (int i = 0; i < 2; ++i) {
    const LatLongImage picture = exr("f_" + std::to_string(i) + ".exr");
    ASSERT_EQ(std::pair(picture.width, picture.height), std::pair(40, 30));
    // The upper left corner is far from every object: unshadowed ground, or nothing.
    EXPECT_NEAR(picture.at(0, 0)[0], 3 * (5.0f + static_cast<float>(i)), 1e-4f);
  }
}

TEST_F(Viewing, AnEightBitPlateKeepsItsCodesAndSaysWhatItsWhiteCountsAs) {
  std::vector<std::uint8_t> codes;
  for (int i = 0; i < 80 * 60; ++i)
    for (const int code : {i, 255 - i / 8, 3 * i, 255}) codes.push_back(static_cast<std::uint8_t>(code));
  ASSERT_TRUE(render::write_png(file("plate.png"), {80, 60, codes}));
  ChildProcess program =
      start({"--background", file("plate.png"), "--out", file("a.exr"), "--out", file("a.png")});
  ASSERT_EQ(program.wait(), 0);
  // A white floor under 1000 lx from (1, 2, 1): 1000 · (2 / √6) / π = 260 cd/m².
  EXPECT_NE(program.stderr_text().find("260 cd/m²"), std::string::npos) << program.stderr_text();
  EXPECT_NE(program.stderr_text().find("--plate-white"), std::string::npos) << program.stderr_text();
  const LatLongImage radiance = exr("a.exr");
  const auto before = render::read_plate(file("plate.png"));
  const auto after = render::read_plate(file("a.png"));
  ASSERT_TRUE(before.ok() && after.ok());
  // The first rows are far from every object.
  for (std::size_t i = 0; i < 80 * 5; ++i) {
    ASSERT_TRUE((after->pixels[i] == before->pixels[i]).all()) << i;
    ASSERT_NEAR(radiance.pixels[i][0], 259.9f * before->pixels[i][0], 0.05f) << i;
  }
}

TEST_F(Viewing, AnExrPlateIsRadianceUnlessItIsToldToBeGraded) {
  const std::vector<float> rgba(std::size_t{4} * 40 * 30, 0.25f);
  ASSERT_TRUE(render::write_exr(file("plate.exr"), {40, 30, rgba}));
  for (const std::string values : {"graded", "radiance"}) {
    ChildProcess program = start({"--background", file("plate.exr"), "--plate-values", values,
                                  "--plate-white", "100", "--out", file(values + ".png"), "--exposure", "6"});
    ASSERT_EQ(program.wait(), 0) << program.stderr_text();
    const auto picture = render::read_plate(file(values + ".png"));
    ASSERT_TRUE(picture.ok());
    const float first = picture->pixels[0][0];
    if (values == "graded") EXPECT_NEAR(first, 0.25f, 0.004f);  // half a code there
    // EV 6: 8 cd/m² is middle grey, so 25 are 0.5625, and Reinhard's equation 4 with white at 5.76 follows.
    else
      EXPECT_NEAR(first, 0.5625f * (1 + 0.5625f / 33.18f) / 1.5625f, 0.004f);
  }
}

TEST_F(Viewing, ATrackerMovesTheCameraWhichStaysWhenTheStreamStops) {
  ChildProcess still = start({"--size", "32x24", "--out", file("still.exr")});
  ASSERT_EQ(still.wait(), 0) << still.stderr_text();
  ChildProcess program = start({"--size", "32x24", "--seconds", "600", "--tracking", "freed:127.0.0.1:0",
                                "--out", file("tracked.exr")});
  const auto port = program.wait_for_line("waiting for tracking on port ");
  ASSERT_TRUE(port) << program.stderr_text();
  // 1 m above the floor, 3 m in front of the middle, looking along the stage's +Y.
  std::vector<std::uint8_t> packet(29, 0);
  packet[0] = 0xD1;
  const auto put = [&](std::size_t at, int value) {
    for (std::size_t k = 0; k < 3; ++k)
      packet[at + k] = static_cast<std::uint8_t>(static_cast<std::uint32_t>(value) >> (16 - 8 * k) & 255);
  };
  put(14, -3000 * 64);
  put(17, 1000 * 64);
  std::uint8_t checksum = 0x40;
  for (std::size_t k = 0; k < 28; ++k) checksum = static_cast<std::uint8_t>(checksum - packet[k]);
  packet[28] = checksum;
  sockaddr_in to{};
  to.sin_family = AF_INET;
  const std::string number = port->substr(port->find_last_of(' ') + 1);
  to.sin_port = htons(static_cast<std::uint16_t>(std::stoi(number)));
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int sender = ::socket(AF_INET, SOCK_DGRAM, 0);
  ASSERT_EQ(::sendto(sender, packet.data(), packet.size(), 0, reinterpret_cast<sockaddr*>(&to), sizeof to),
            29);
  ::close(sender);
  ASSERT_TRUE(program.wait_for_line("tracking from 127.0.0.1")) << program.stderr_text();
  ASSERT_TRUE(program.wait_for_line("no tracking for 1 s; keeping the last pose")) << program.stderr_text();
  program.send(SIGTERM);
  ASSERT_EQ(program.wait(), 0) << program.stderr_text();
  const LatLongImage before = exr("still.exr");
  const LatLongImage after = exr("tracked.exr");
  float difference = 0;
  for (std::size_t i = 0; i < before.pixels.size(); ++i)
    difference += (before.pixels[i] - after.pixels[i]).abs().sum();
  EXPECT_GT(difference, 1);
}

TEST_F(Viewing, WrongOptionsAreRefusedInOneLine) {
  expect_refused({"--background", file("none.png")}, 3, "none.png");
  expect_refused({"--background", lights_}, 3, "lights.json");
  expect_refused({"--plate-white", "2"}, 2, "--plate-white");
  expect_refused({"--plate-values", "graded"}, 2, "--plate-values");
  expect_refused({"--background", "a.png", "--plate-values", "log"}, 2, "--plate-values");
  expect_refused({"--tracking", "freed"}, 2, "--tracking");
  expect_refused({"--tracking", "opentrackio:203.0.113.7:6301"}, 1,
                 "203.0.113.7");  // nobody's address (RFC 5737)
  expect_refused({"--freed-focal", "1"}, 2, "--freed-focal");
  expect_refused({"--exposure", "nan"}, 2, "--exposure");
  expect_refused({"--display", "p3"}, 2, "--display");
  expect_refused({"--screen"}, 2, "--screen");  // and --headless
}

}  // namespace
}  // namespace lightwell
