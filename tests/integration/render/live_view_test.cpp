// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// What a crew looks at, under live light whose daemon dies and returns.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <thread>

#include "interface/atomic_file.h"
#include "interface/exr_file.h"
#include "render/picture.h"
#include "tests/integration/render/fake_probe.h"
#include "tests/integration/render/program.h"
#include "tests/support/dds.h"
#include "tests/support/eventually.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/virtual_display.h"

namespace lightwell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

// A probe that sends until it is gone.
class RunningProbe {
 public:
  RunningProbe(const DdsOptions& options, float power)
      : probe_(options, power), thread_([this] {
          while (!stop_) probe_.send();
        }) {}
  ~RunningProbe() {
    stop_ = true;
    thread_.join();
  }
  RunningProbe(const RunningProbe&) = delete;
  RunningProbe& operator=(const RunningProbe&) = delete;

 private:
  FakeProbe probe_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

constexpr float kWhite = 400;  // cd/m² of the plate's 1
constexpr float kPlate = 0.5f;

class LiveView : public ::testing::Test {
 protected:
  void SetUp() override {
    if (display_.name().empty()) GTEST_SKIP() << "Xvfb is missing (package xvfb)";
    ::setenv("DISPLAY", display_.name().c_str(), 1);
    ::unsetenv("WAYLAND_DISPLAY");
    if (run_process("xdotool", {"version"}).exit_code != 0)
      GTEST_SKIP() << "xdotool is missing (package xdotool)";
    const std::vector<float> rgba(std::size_t{4} * 200 * 150, kPlate);
    ASSERT_TRUE(render::write_exr(folder_.path() / "plate.exr", {200, 150, rgba}));
    program_.emplace(
        std::vector<std::string>{"env", "-C", folder_.path().string(), LIGHTWELL_BIN_DIR "/lightwell-render",
                                 "--scene", LIGHTWELL_STAGE, "--live", "--domain",
                                 std::to_string(dds_.domain), "--size", "200x150", "--shadow-size", "64",
                                 "--background", "plate.exr", "--plate-white", std::to_string(kWhite),
                                 "--probe"},
        folder_.path() / "stderr.txt");
    const ProcessResult found =
        run_process("timeout", {"60", "xdotool", "search", "--sync", "--name", "Lightwell"});
    ASSERT_EQ(found.exit_code, 0) << found.err;
    window_ = found.out.substr(0, found.out.find('\n'));
    ASSERT_EQ(run_process("xdotool", {"windowfocus", "--sync", window_}).exit_code, 0);
  }
  static void press(const std::string& key) { ASSERT_EQ(run_process("xdotool", {"key", key}).exit_code, 0); }
  [[nodiscard]] std::string title() const { return run_process("xdotool", {"getwindowname", window_}).out; }
  // What the title says of the light's age; negative: nothing.
  [[nodiscard]] double age_s() const {
    const std::string text = title();
    const auto at = text.find(" lights – light ");
    return at == std::string::npos
               ? -1
               : std::strtod(text.c_str() + at + std::string(" lights – light ").size(), nullptr);
  }
  LatLongImage screenshot() {
    press("c");
    const std::string number = std::to_string(++shots_);
    const std::string name = "lightwell-" + std::string(4 - number.size(), '0') + number;
    EXPECT_TRUE(program_->wait_for_line("wrote " + name + ".png and " + name + ".exr"))
        << program_->stderr_text();
    const auto bytes = read_text_file(folder_.path() / (name + ".exr"));
    EXPECT_TRUE(bytes.ok());
    auto image = read_exr(*bytes, name, 1 << 20);
    EXPECT_TRUE(image.ok());
    return image.ok() ? *image : LatLongImage{};
  }
  // The sky is a message of its own, and may come after the light.
  void wait_for_sky(float power) {
    while (shots_ < 50 && mirror_ball(screenshot())[0] != FakeProbe::kSky * power) continue;
  }
  // Balls of 30 pixels, 3 from the edge and from each other's: their middles.
  static Rgb grey_ball(const LatLongImage& picture) { return picture.at(18, 150 - 18); }
  static Rgb mirror_ball(const LatLongImage& picture) { return picture.at(51, 150 - 18); }

  // Plate, grey ball and mirror ball under the probe's light.
  static void expect_light(const LatLongImage& picture, float power) {
    ASSERT_EQ(picture.width, 200);
    const Rgb plate = Rgb::Constant(kPlate * kWhite);
    EXPECT_LT((picture.at(0, 0) - plate).abs().maxCoeff(), 1e-3f * plate[0]) << "far from every object";
    // The camera looks down by 0.26: what of the ball is nearest to it sees the light at 1.31 from its normal. A pixel
    // of the ball's 15 moves its cosine by a fifth.
    const Rgb grey = 0.18f / static_cast<float>(kPi) * Rgb(100, 200, 300) * power * std::sin(0.26f);
    EXPECT_LT(((grey_ball(picture) - grey) / grey).abs().maxCoeff(), 0.2f) << grey_ball(picture).transpose();
    EXPECT_LT((mirror_ball(picture) / (FakeProbe::kSky * power) - 1).abs().maxCoeff(), 1e-3f)
        << mirror_ball(picture).transpose();
  }

  TemporaryFolder folder_;
  DdsOptions dds_ = own_domain();
  VirtualDisplay display_;
  std::optional<ChildProcess> program_;
  std::string window_;
  int shots_ = 0;
};

TEST_F(LiveView, KeepsTheLastLightAndItsAgeGrowsUntilTheDaemonReturns) {
  {
    const RunningProbe probe(dds_, 1);
    ASSERT_TRUE(eventually([&] { return age_s() >= 0; })) << title() << program_->stderr_text();
    press("d");  // dome and help lie over the picture, in no file
    press("h");
    wait_for_sky(1);
    expect_light(screenshot(), 1);
    EXPECT_TRUE(eventually([&] { return age_s() >= 0 && age_s() < 1.5; })) << title();
  }
  ASSERT_TRUE(program_->wait_for_line("no light for 2 s; keeping the last")) << program_->stderr_text();
  ASSERT_TRUE(eventually([&] { return age_s() > 2; })) << title();
  expect_light(screenshot(), 1);
  press("Left");
  press("Home");
  expect_light(screenshot(), 1);

  const RunningProbe probe(dds_, 2);
  ASSERT_TRUE(eventually([&] { return age_s() >= 0 && age_s() < 1.5; })) << title();
  wait_for_sky(2);
  expect_light(screenshot(), 2);
  press("q");
  EXPECT_EQ(program_->wait_for_end(), 0) << program_->stderr_text();
}

}  // namespace
}  // namespace lightwell
