// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "interface/atomic_file.h"
#include "interface/environment_io.h"
#include "interface/light_set_io.h"
#include "render/egl_context.h"
#include "tests/integration/render/program.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_scene.h"

namespace lightwell {
namespace {

using test::ChildProcess;
using test::start_render;

class Command : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto context = render::EglContext::create();
    if (!context) GTEST_SKIP() << context.error().message;
    ASSERT_TRUE(write_light_set(lights_, test::light_set({{Vec3f(1, 2, 1), Rgb::Constant(1000)},
                                                          {Vec3f(-1, 1, 0), Rgb(100, 200, 300)}})));
  }

  std::vector<std::string> arguments(std::vector<std::string> more) const {
    std::vector<std::string> all = {"--scene", LIGHTWELL_STAGE, "--light-set",   lights_, "--headless",
                                    "--size",  "32x24",         "--shadow-size", "64"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  void expect_refused(const std::vector<std::string>& words, int exit_code, const std::string& named,
                      const std::vector<std::string>& environment = {}) {
    ChildProcess program = start_render(folder_.path(), words, environment);
    EXPECT_EQ(program.wait(), exit_code) << named;
    const std::string errors = program.stderr_text();
    EXPECT_NE(errors.find(named), std::string::npos) << errors;
    EXPECT_EQ(std::count(errors.begin(), errors.end(), '\n'), 1) << errors;
  }
  [[nodiscard]] std::string file(const std::string& name) const { return (folder_.path() / name).string(); }

  test::TemporaryFolder folder_;
  std::string lights_ = (folder_.path() / "lights.json").string();
};

TEST_F(Command, WritesFramesNumberedFromZeroAndTheStatisticsOfTheContract) {
  ChildProcess program =
      start_render(folder_.path(), arguments({"--frames", "2", "--out", file("f_%04d.exr"), "--out",
                                              file("last.png"), "--stats", file("stats.json")}));
  ASSERT_EQ(program.wait(), 0) << program.stderr_text();
  EXPECT_TRUE(std::filesystem::exists(file("f_0000.exr")));
  EXPECT_TRUE(std::filesystem::exists(file("f_0001.exr")));
  EXPECT_FALSE(std::filesystem::exists(file("f_0002.exr")));
  EXPECT_TRUE(std::filesystem::exists(file("last.png")));
  const auto stats = nlohmann::json::parse(read_text_file(file("stats.json")).value());
  std::set<std::string> keys;
  for (const auto& [key, value] : stats.items()) keys.insert(key);
  EXPECT_EQ(keys, (std::set<std::string>{"frames", "ms", "cpu_ms", "passes", "lights", "shadow_maps",
                                         "shadow_size", "triangles", "predicted_error", "gl_renderer"}));
  EXPECT_EQ(stats["frames"], 2);
  EXPECT_EQ(stats["lights"], 2);
  EXPECT_EQ(stats["shadow_maps"], 2);
  EXPECT_EQ(stats["shadow_size"], 64);
  EXPECT_EQ(stats["triangles"], 16194);
  EXPECT_GT(stats["ms"]["p50"], 0);
  EXPECT_GT(stats["cpu_ms"]["p50"], 0);
  for (const char* pass : {"shadow", "gbuffer", "shading", "tonemap"}) EXPECT_GT(stats["passes"][pass], 0);
}

// An environment of uniform radiance 1: the open ground receives π from the hemisphere.
// A frame in a hundred seconds is what any machine affords.
TEST_F(Command, AFrameRateIsKeptFromFewLightsOnAndTheErrorOfItsChoiceIsTold) {
  std::vector<std::pair<Vec3f, Rgb>> lights;
  for (int i = 0; i < 24; ++i) {
    const float around = 0.9f * static_cast<float>(i);
    lights.emplace_back(Vec3f(std::sin(around), 1, std::cos(around)).normalized(), Rgb::Constant(100));
  }
  ASSERT_TRUE(write_light_set(lights_, test::light_set(lights)));
  const auto chosen = [&](const char* frames) {
    ChildProcess program =
        start_render(folder_.path(),
                     arguments({"--frames", frames, "--target-fps", "0.01", "--stats", file("stats.json")}));
    EXPECT_EQ(program.wait(), 0) << program.stderr_text();
    return nlohmann::json::parse(read_text_file(file("stats.json")).value()).at("chosen");
  };
  const auto first = chosen("1"), last = chosen("80");
  EXPECT_EQ(first["lights"], 16);
  EXPECT_EQ(last["lights"], 24);
  EXPECT_EQ(last["shadow_texels"], 1.0);
  EXPECT_LT(last["expected_error"], first["expected_error"]);
  EXPECT_GT(last["expected_error"], 0);
}

TEST_F(Command, AUniformEnvironmentReturnsAlbedoAndTheLowerHalfAddsNothingToTheGround) {
  ASSERT_TRUE(
      write_environment(file("sky.exr"), LatLongImage{64, 32, std::vector<Rgb>(64 * 32, Rgb::Ones())}));
  for (const char* part : {"--hemisphere", "--sphere"}) {
    ChildProcess program =
        start_render(folder_.path(),
                     {"--scene", LIGHTWELL_STAGE, "--environment", file("sky.exr"), part, "--lights", "64",
                      "--headless", "--size", "32x24", "--shadow-size", "64", "--out", file("sky_out.exr")});
    ASSERT_EQ(program.wait(), 0) << program.stderr_text();
    const auto picture = read_environment(file("sky_out.exr"));
    ASSERT_TRUE(picture.ok());
    // 64 lights of a uniform sky err by less than this on a normal; the objects hide a little of it.
    EXPECT_NEAR(picture->image.at(16, 23)[0], 0.42f, 0.42f * 0.1f) << part;
  }
}

TEST_F(Command, ASpinningEnvironmentTurnsTheShadows) {
  LatLongImage lamp{64, 32, std::vector<Rgb>(64 * 32, Rgb::Zero())};
  lamp.at(10, 12) = Rgb::Constant(1000);
  ASSERT_TRUE(write_environment(file("lamp.exr"), lamp));
  ChildProcess program =
      start_render(folder_.path(),
                   {"--scene", LIGHTWELL_STAGE, "--environment", file("lamp.exr"), "--lights", "1", "--spin",
                    "180", "--frames", "3", "--headless", "--size", "32x24", "--out", file("l_%d.exr")});
  ASSERT_EQ(program.wait(), 0) << program.stderr_text();
  const auto first = read_environment(file("l_0.exr"));
  const auto half = read_environment(file("l_1.exr"));
  const auto whole = read_environment(file("l_2.exr"));
  ASSERT_TRUE(first.ok() && half.ok() && whole.ok());
  float turned = 0;
  for (std::size_t i = 0; i < first->image.pixels.size(); ++i) {
    EXPECT_NEAR(whole->image.pixels[i][0], first->image.pixels[i][0], 1e-4f);
    turned = std::max(turned, std::abs(half->image.pixels[i][0] - first->image.pixels[i][0]));
  }
  EXPECT_GT(turned, 0.1f);
}

TEST_F(Command, FewerShadowMapsThanLightsFoldTheLights) {
  ChildProcess program =
      start_render(folder_.path(), arguments({"--shadow-maps", "1", "--stats", file("stats.json")}));
  ASSERT_EQ(program.wait(), 0) << program.stderr_text();
  EXPECT_EQ(nlohmann::json::parse(read_text_file(file("stats.json")).value())["lights"], 1);
}

TEST_F(Command, BadInputNamesTheFileAndEndsWith3) {
  ASSERT_TRUE(write_file_atomically(file("broken.json"), R"({"schema": "lightwell.lights/1", "lights": [{)"));
  ASSERT_TRUE(write_file_atomically(file("broken.gltf"), R"({"asset": {"version": "2.0"}})"));
  expect_refused({"--scene", file("none.gltf"), "--light-set", lights_, "--headless"}, 3, "none.gltf");
  expect_refused({"--scene", file("broken.gltf"), "--light-set", lights_, "--headless"}, 3, "broken.gltf");
  expect_refused({"--scene", folder_.path().string(), "--light-set", lights_, "--headless"}, 3, "directory");
  expect_refused({"--scene", LIGHTWELL_STAGE, "--environment", file("none.exr"), "--headless"}, 3,
                 "none.exr");
  expect_refused({"--scene", LIGHTWELL_STAGE, "--light-set", file("broken.json"), "--headless"}, 3,
                 "broken.json");
}

TEST_F(Command, WrongUsageNamesTheOptionAndEndsWith2) {
  expect_refused({"--scene", LIGHTWELL_STAGE, "--headless"}, 2, "--environment");
  expect_refused(arguments({"--lights", "8"}), 2, "--environment");
  expect_refused({"--scene", LIGHTWELL_STAGE, "--environment", "x.exr", "--method", "guess"}, 2,
                 "median-cut");
  expect_refused({"--light-set", lights_, "--headless"}, 2, "--scene");
  expect_refused({"--scene", LIGHTWELL_STAGE, "--light-set", lights_, "--live"}, 2, "--live");
  expect_refused(arguments({"--no-such-option"}), 2, "--no-such-option");
  expect_refused(arguments({"--size", "0x5"}), 2, "--size");
  expect_refused(arguments({"--frames", "0"}), 2, "--frames");
  expect_refused(arguments({"--samples", "0"}), 2, "--samples");
  expect_refused(arguments({"--out", "a.jpg"}), 2, "a.jpg");
  expect_refused(arguments({"--camera", "nobody"}), 2, "'stage'");
}

TEST_F(Command, AMissingOutputFolderIsAFailureBeforeAnythingIsRendered) {
  expect_refused(arguments({"--out", file("no/such/a.exr")}), 1, "no/such");
}

TEST_F(Command, WithoutADisplayAndAPurposeItSaysSo) {
  expect_refused({"--scene", LIGHTWELL_STAGE, "--light-set", lights_}, 1, "no display",
                 {"DISPLAY", "WAYLAND_DISPLAY"});
}

TEST_F(Command, WithoutADisplayButAPurposeItRendersOffScreen) {
  ChildProcess program = start_render(folder_.path(),
                                      {"--scene", LIGHTWELL_STAGE, "--light-set", lights_, "--size", "16x12",
                                       "--shadow-size", "16", "--out", file("a.png")},
                                      {"DISPLAY", "WAYLAND_DISPLAY"});
  EXPECT_EQ(program.wait(), 0) << program.stderr_text();
  EXPECT_TRUE(std::filesystem::exists(file("a.png")));
}

TEST_F(Command, WithoutAnEglDriverItSaysSoInOneLine) {
  // The loader of EGL drivers looks only where this says: nowhere.
  expect_refused(arguments({}), 1, "EGL", {"__EGL_VENDOR_LIBRARY_FILENAMES=/nonexistent"});
}

TEST_F(Command, ATerminationSignalEndsInOrderWithThePictureWritten) {
  ChildProcess program = start_render(
      folder_.path(), arguments({"--seconds", "600", "--out", file("f_%d.png"), "--out", file("last.exr")}));
  while (!std::filesystem::exists(file("f_0.png")) && program.running())
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  program.send(SIGTERM);
  EXPECT_EQ(program.wait(), 0) << program.stderr_text();
  EXPECT_TRUE(std::filesystem::exists(file("last.exr")));
}

TEST_F(Command, HelpEndsWell) {
  ChildProcess program = start_render(folder_.path(), {"--help"});
  EXPECT_EQ(program.wait(), 0);
}

TEST_F(Command, DoesNotWriteOverWhatItReads) {
  const std::string before = read_text_file(lights_).value();
  expect_refused(arguments({"--stats", lights_}), 2, "is also the input");
  EXPECT_EQ(read_text_file(lights_).value(), before);
}

}  // namespace
}  // namespace lightwell
