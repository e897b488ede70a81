// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fcntl.h>

#include "interface/light_set_io.h"
#include "render/renderer.h"
#include "render/window.h"
#include "tests/integration/render/program.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_scene.h"

namespace lightwell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

// A display without a screen, on a number that the server chooses.
class VirtualDisplay {
 public:
  VirtualDisplay() {
    int ends[2];
    if (::pipe(ends) != 0) return;
    pid_ = ::fork();
    if (pid_ == 0) {
      const std::string fd = std::to_string(ends[1]);
      const int null = ::open("/dev/null", O_WRONLY);
      ::dup2(null, STDERR_FILENO);
      ::execlp("Xvfb", "Xvfb", "-displayfd", fd.c_str(), "-screen", "0", "800x600x24", "-nolisten", "tcp",
               nullptr);
      ::_exit(127);
    }
    ::close(ends[1]);
    char text[16] = "";
    if (::read(ends[0], text, sizeof text - 1) > 0) name_ = ":" + std::to_string(std::atoi(text));
    ::close(ends[0]);
  }
  ~VirtualDisplay() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGTERM);
    ::waitpid(pid_, nullptr, 0);
  }
  VirtualDisplay(const VirtualDisplay&) = delete;
  VirtualDisplay& operator=(const VirtualDisplay&) = delete;
  [[nodiscard]] const std::string& name() const { return name_; }  // empty: there is no Xvfb

 private:
  pid_t pid_ = 0;
  std::string name_;
};

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
    (*window)->show();
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

}  // namespace
}  // namespace lightwell
