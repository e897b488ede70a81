// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/window.h"

#include <EGL/egl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>

namespace lightwell::render {
namespace {

Window* owner(GLFWwindow* window) {
  return static_cast<Window*>(glfwGetWindowUserPointer(window));
}

Error glfw_failure(const char* what) {
  const char* why = nullptr;
  glfwGetError(&why);
  return {ErrorKind::failed, std::string(what) + (why != nullptr ? std::string(": ") + why : "")};
}

}  // namespace

Window::Window(GLFWwindow* window, Orbit orbit) : window_(window), orbit_(std::move(orbit)) {
  glfwSetWindowUserPointer(window, this);
  followed_ = orbit_.camera();
  glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int) {
    if (action != GLFW_RELEASE) owner(w)->press(key);
  });
  glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) { owner(w)->drag(x, y); });
  glfwSetScrollCallback(window, [](GLFWwindow* w, double, double dy) {
    owner(w)->zoom(static_cast<float>(std::pow(0.9, dy)));
  });
  glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int, int) { owner(w)->changed_ = true; });
  glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { owner(w)->changed_ = true; });
}

// Without a name: another key for the one before.
struct Window::Key {
  int key;
  const char* name;
  const char* does;
  void (*act)(Window&);
};

std::span<const Window::Key> Window::keys() {
  using W = Window;
  constexpr float kNearer = 0.9f;
  constexpr double kThirdOfAStop = 1.0 / 3;
  static const Key all[] = {
      {GLFW_KEY_LEFT, "arrows", "turn the camera", [](W& w) { w.turn(-1, 0); }},
      {GLFW_KEY_RIGHT, nullptr, nullptr, [](W& w) { w.turn(1, 0); }},
      {GLFW_KEY_UP, nullptr, nullptr, [](W& w) { w.turn(0, 1); }},
      {GLFW_KEY_DOWN, nullptr, nullptr, [](W& w) { w.turn(0, -1); }},
      {GLFW_KEY_EQUAL, "+ -", "nearer, farther", [](W& w) { w.zoom(kNearer); }},  // + without Shift
      {GLFW_KEY_KP_ADD, nullptr, nullptr, [](W& w) { w.zoom(kNearer); }},
      {GLFW_KEY_MINUS, nullptr, nullptr, [](W& w) { w.zoom(1 / kNearer); }},
      {GLFW_KEY_KP_SUBTRACT, nullptr, nullptr, [](W& w) { w.zoom(1 / kNearer); }},
      {GLFW_KEY_HOME, "Home", "back to the scene's or the tracked camera", [](W& w) { w.go_home(); }},
      {GLFW_KEY_H, "h", "this help", [](W& w) { w.switch_overlay(&WindowSwitches::help); }},
      {GLFW_KEY_N, "n", "numbers", [](W& w) { w.switch_overlay(&WindowSwitches::numbers); }},
      {GLFW_KEY_D, "d", "where lights are, on a dome", [](W& w) { w.switch_overlay(&WindowSwitches::dome); }},
      {GLFW_KEY_S, "s", "shadows", [](W& w) { w.switch_picture(&WindowSwitches::shadows); }},
      {GLFW_KEY_L, "l", "light lists", [](W& w) { w.switch_picture(&WindowSwitches::lists_the_other_way); }},
      {GLFW_KEY_P, "p", "grey and mirror ball", [](W& w) { w.switch_picture(&WindowSwitches::probe); }},
      {GLFW_KEY_RIGHT_BRACKET, "] [", "brighter, darker", [](W& w) { w.expose(kThirdOfAStop); }},
      {GLFW_KEY_LEFT_BRACKET, nullptr, nullptr, [](W& w) { w.expose(-kThirdOfAStop); }},
      {GLFW_KEY_C, "c", "screenshot, PNG and EXR", [](W& w) { w.screenshot_ = true; }},
      {GLFW_KEY_F, "f", "full screen", [](W& w) { w.toggle_full_screen(); }},
      {GLFW_KEY_Q, "Esc, q", "close", [](W& w) { glfwSetWindowShouldClose(w.window_, GLFW_TRUE); }},
      {GLFW_KEY_ESCAPE, nullptr, nullptr, [](W& w) { glfwSetWindowShouldClose(w.window_, GLFW_TRUE); }}};
  return all;
}

std::vector<std::string> Window::help_lines() {
  std::vector<std::string> lines = {"drag         turn the camera", "right drag   move it",
                                    "wheel        nearer, farther"};
  constexpr std::size_t kColumn = 13;
  for (const Key& key : keys()) {
    if (key.name == nullptr) continue;
    std::string name = key.name;
    name.resize(kColumn, ' ');
    lines.push_back(name + key.does);
  }
  return lines;
}

void Window::press(int key) {
  for (const Key& known : keys())
    if (known.key == key) known.act(*this);
}

void Window::turn(float right, float up) {
  constexpr float kStep_rad = 0.05f;
  orbit_.turn(right * kStep_rad, up * kStep_rad);
  changed_ = taken_ = true;
}

void Window::zoom(float factor) {
  orbit_.zoom(factor);
  changed_ = taken_ = true;
}

void Window::expose(double stops) {
  exposure_steps_ += stops;
  changed_ = true;
}

void Window::switch_picture(bool WindowSwitches::*what) {
  switches_.*what = !(switches_.*what);
  changed_ = true;
}

void Window::switch_overlay(bool WindowSwitches::*what) {
  switches_.*what = !(switches_.*what);
  overlay_changed_ = true;
}

void Window::go_home() {
  orbit_.start_at(followed_);
  taken_ = false;
  changed_ = true;
}

void Window::drag(double x, double y) {
  const auto right = static_cast<float>(last_x_ - x);
  const auto up = static_cast<float>(y - last_y_);
  last_x_ = x;
  last_y_ = y;
  if (glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS) {
    constexpr float kRadiansPerPixel = 0.006f;
    orbit_.turn(right * kRadiansPerPixel, up * kRadiansPerPixel);
  } else if (glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_RIGHT) == GLFW_PRESS) {
    // What is under the pointer follows it, as far away as the target.
    const float picture =
        2 * std::tan(orbit_.camera().yfov_rad / 2) / static_cast<float>(std::max(size().second, 1));
    orbit_.slide(right * picture, up * picture);
  } else {
    return;
  }
  changed_ = taken_ = true;
}

void Window::toggle_full_screen() {
  if (glfwGetWindowMonitor(window_) != nullptr) {
    glfwSetWindowMonitor(window_, nullptr, windowed_[0], windowed_[1], windowed_[2], windowed_[3],
                         GLFW_DONT_CARE);
    return;
  }
  GLFWmonitor* monitor = glfwGetPrimaryMonitor();
  const GLFWvidmode* mode = monitor != nullptr ? glfwGetVideoMode(monitor) : nullptr;
  if (mode == nullptr) return;  // a screen was unplugged
  glfwGetWindowPos(window_, &windowed_[0], &windowed_[1]);
  glfwGetWindowSize(window_, &windowed_[2], &windowed_[3]);
  glfwSetWindowMonitor(window_, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
}

Result<std::unique_ptr<Window>> Window::open(int width, int height, Orbit orbit) {
  if (glfwInit() != GLFW_TRUE) return glfw_failure("no display for a window");
  glfwWindowHint(GLFW_CLIENT_API, GLFW_OPENGL_ES_API);
  glfwWindowHint(GLFW_CONTEXT_CREATION_API, GLFW_EGL_CONTEXT_API);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 1);
  glfwWindowHint(GLFW_DEPTH_BITS, 0);
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
  GLFWwindow* window = glfwCreateWindow(width, height, "Lightwell", nullptr, nullptr);
  if (window == nullptr) {
    Error error = glfw_failure("cannot open a window with OpenGL ES 3.1");
    glfwTerminate();
    return error;
  }
  glfwMakeContextCurrent(window);
  glfwSwapInterval(1);
  return std::unique_ptr<Window>(new Window(window, std::move(orbit)));
}

Window::~Window() {
  glfwDestroyWindow(window_);
  glfwTerminate();
}

void Window::poll(double wait_s) {
  if (wait_s > 0)
    glfwWaitEventsTimeout(wait_s);
  else
    glfwPollEvents();
}

// GLFW asks EGL for a context that tells of its loss in a way that OpenGL ES does not know, so swapping has to tell.
Status Window::show() {
  glfwSwapBuffers(window_);
  if (eglGetError() != EGL_CONTEXT_LOST) return {};
  return Error{ErrorKind::failed,
               "the OpenGL ES context is lost: the graphics driver was reset; it must be started again"};
}
bool Window::closed() const {
  return glfwWindowShouldClose(window_) != 0;
}

std::pair<int, int> Window::size() const {
  int width = 0;
  int height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  return {width, height};
}

bool Window::take_changed() {
  return std::exchange(changed_, false);
}

SceneCamera Window::camera() const {
  SceneCamera camera = orbit_.camera();
  camera.aspect = 0;  // the window's own
  return camera;
}

void Window::follow(const SceneCamera& camera) {
  followed_ = camera;
  if (!taken_) orbit_.start_at(camera);
}

void Window::set_title(const std::string& title) {
  glfwSetWindowTitle(window_, title.c_str());
}

}  // namespace lightwell::render
