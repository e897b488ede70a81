// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "interface/atomic_file.h"
#include "interface/exr_file.h"
#include "interface/light_set_io.h"
#include "render/renderer.h"
#include "render/window.h"
#include "tests/integration/render/program.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_scene.h"
#include "tests/support/virtual_display.h"

namespace lightwell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

class WindowOnAVirtualDisplay : public ::testing::Test {
 protected:
  void SetUp() override {
    if (display_.name().empty()) GTEST_SKIP() << "Xvfb is missing (package xvfb)";
    ::setenv("DISPLAY", display_.name().c_str(), 1);
    ::unsetenv("WAYLAND_DISPLAY");
  }
  VirtualDisplay display_;
};

TEST_F(WindowOnAVirtualDisplay, OpensRendersResizesAndCloses) {
  Scene scene;
  add_ground(scene, lambertian(Rgb::Ones()));
  const SceneCamera camera = camera_at({0, 3, 0.1f}, {0, 0, 0});
  auto window = render::Window::open(160, 120, render::Orbit(camera, scene));
  ASSERT_TRUE(window.ok()) << window.error().message;
  auto renderer = render::Renderer::create(scene, {});
  ASSERT_TRUE(renderer.ok()) << renderer.error().message;
  const LightSet lights = light_set({{Vec3f::UnitY(), Rgb::Constant(static_cast<float>(kPi))}});
  EXPECT_TRUE((*window)->take_changed());
  for (int frame = 0; frame < 30; ++frame) {
    if (frame == 10) glfwSetWindowSize((*window)->handle(), 201, 99);
    (*window)->poll();
    const auto [width, height] = (*window)->size();
    ASSERT_TRUE(renderer->resize(width, height));
    ASSERT_TRUE(renderer->render(lights, (*window)->camera()));
    renderer->tone_map(render::ToneMap::none, 0.04);
    renderer->present();
    ASSERT_TRUE((*window)->show());
  }
  while ((*window)->size() != std::pair(201, 99)) (*window)->poll(0.01);
  ASSERT_TRUE(renderer->resize(201, 99));
  ASSERT_TRUE(renderer->render(lights, (*window)->camera()));
  EXPECT_EQ(renderer->radiance().rgba.size(), 201u * 99 * 4);
  EXPECT_TRUE((*window)->take_changed());
  EXPECT_FALSE((*window)->closed());
  glfwSetWindowShouldClose((*window)->handle(), GLFW_TRUE);
  EXPECT_TRUE((*window)->closed());
}

TEST_F(WindowOnAVirtualDisplay, TheProgramShowsThirtyFramesAndEnds) {
  const TemporaryFolder folder;
  const std::string lights = (folder.path() / "lights.json").string();
  ASSERT_TRUE(write_light_set(lights, light_set({{Vec3f(1, 2, 1), Rgb::Constant(1000)}})));
  const std::string picture = (folder.path() / "last.png").string();
  ChildProcess program =
      start_render(folder.path(), {"--scene", LIGHTWELL_STAGE, "--light-set", lights, "--size", "64x48",
                                   "--shadow-size", "32", "--frames", "30", "--out", picture});
  EXPECT_EQ(program.wait(), 0) << program.stderr_text();
  EXPECT_EQ(program.stderr_text(), "");
  EXPECT_TRUE(std::filesystem::exists(picture));
}

// Keys, as a person presses them: through the X server, to the program's window.
class Keyboard : public WindowOnAVirtualDisplay {
 protected:
  void SetUp() override {
    WindowOnAVirtualDisplay::SetUp();
    if (IsSkipped()) return;
    if (run_process("xdotool", {"version"}).exit_code != 0)
      GTEST_SKIP() << "xdotool is missing (package xdotool)";
    ASSERT_TRUE(write_light_set(file("lights.json"), light_set({{Vec3f(1, 2, 1), Rgb::Constant(1000)},
                                                                {Vec3f(-1, 1, 0), Rgb(100, 200, 300)}})));
    program_.emplace(
        std::vector<std::string>{"env", "-C", folder_.path().string(), LIGHTWELL_BIN_DIR "/lightwell-render",
                                 "--scene", LIGHTWELL_STAGE, "--light-set", "lights.json", "--size",
                                 "200x150", "--shadow-size", "64"},
        folder_.path() / "stderr.txt");
    const ProcessResult found = run_process("xdotool", {"search", "--sync", "--name", "Lightwell"});
    ASSERT_EQ(found.exit_code, 0) << found.err;
    window_ = found.out.substr(0, found.out.find('\n'));
    // Without a window manager nothing gives it the keyboard.
    ASSERT_EQ(run_process("xdotool", {"windowfocus", "--sync", window_}).exit_code, 0);
  }
  [[nodiscard]] std::string file(const std::string& name) const { return (folder_.path() / name).string(); }
  static void press(const std::string& key) { ASSERT_EQ(run_process("xdotool", {"key", key}).exit_code, 0); }
  // The radiance of the screenshot with this number, once the program says that it is there.
  LatLongImage screenshot(int number) {
    press("c");
    const std::string name = "lightwell-000" + std::to_string(number);
    EXPECT_TRUE(program_->wait_for_line("wrote " + name + ".png and " + name + ".exr"))
        << program_->stderr_text();
    const auto bytes = read_text_file(file(name + ".exr"));
    EXPECT_TRUE(bytes.ok());
    auto image = read_exr(*bytes, name, 1 << 20);
    EXPECT_TRUE(image.ok());
    return image.ok() ? *image : LatLongImage{};
  }
  static float sum(const LatLongImage& image) {
    float total = 0;
    for (const Rgb& pixel : image.pixels) total += pixel.sum();
    return total;
  }

  TemporaryFolder folder_;
  std::optional<ChildProcess> program_;
  std::string window_;
};

TEST_F(Keyboard, SwitchesShadowsTurnsTheCameraAndComesBack) {
  const LatLongImage start = screenshot(1);
  ASSERT_EQ(start.width, 200);
  press("s");
  const LatLongImage unshadowed = screenshot(2);
  EXPECT_GT(sum(unshadowed), 1.001f * sum(start)) << "light without shadows is more";
  press("s");
  press("Left");
  press("h");  // help and the dome are in no picture file
  press("d");
  const LatLongImage turned = screenshot(3);
  EXPECT_NE(sum(turned), sum(start));
  press("Home");
  const LatLongImage back = screenshot(4);
  EXPECT_EQ(sum(back), sum(start));
  press("p");
  EXPECT_NE(sum(screenshot(5)), sum(start)) << "the grey ball";
  press("q");
  EXPECT_EQ(program_->wait_for_end(), 0) << program_->stderr_text();
}

TEST_F(Keyboard, TheWindowIsResizedAndClosedByEscape) {
  ASSERT_EQ(screenshot(1).width, 200);
  ASSERT_EQ(run_process("xdotool", {"windowsize", "--sync", window_, "333", "222"}).exit_code, 0);
  const LatLongImage larger = screenshot(2);
  EXPECT_EQ(std::pair(larger.width, larger.height), std::pair(333, 222));
  press("Escape");
  EXPECT_EQ(program_->wait_for_end(), 0) << program_->stderr_text();
}

}  // namespace
}  // namespace lightwell
