// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/window.h"

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
    owner(w)->orbit_.zoom(static_cast<float>(std::pow(0.9, dy)));
    owner(w)->changed_ = owner(w)->taken_ = true;
  });
  glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int, int) { owner(w)->changed_ = true; });
  glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { owner(w)->changed_ = true; });
}

std::vector<std::string> Window::help_lines() {
  return {"drag          turn the camera",
          "right drag    move it",
          "wheel, + -    nearer, farther",
          "arrows        turn",
          "Home          back to the scene's or the tracked camera",
          "h             this help",
          "n             numbers",
          "d             where the lights are, on a dome",
          "s             shadows",
          "p             grey and mirror ball",
          "[ ]           exposure, a third of a stop",
          "c             screenshot, PNG and EXR",
          "f             full screen",
          "Esc, q        close"};
}

void Window::press(int key) {
  constexpr float kStep_rad = 0.05f;
  constexpr double kThirdOfAStop = 1.0 / 3;
  const auto turn = [&](float right, float up) {
    orbit_.turn(right * kStep_rad, up * kStep_rad);
    taken_ = true;
  };
  const auto zoom = [&](float factor) {
    orbit_.zoom(factor);
    taken_ = true;
  };
  changed_ = true;
  switch (key) {
    case GLFW_KEY_ESCAPE:
    case GLFW_KEY_Q:
      glfwSetWindowShouldClose(window_, GLFW_TRUE);
      break;
    case GLFW_KEY_LEFT:
      turn(-1, 0);
      break;
    case GLFW_KEY_RIGHT:
      turn(1, 0);
      break;
    case GLFW_KEY_UP:
      turn(0, 1);
      break;
    case GLFW_KEY_DOWN:
      turn(0, -1);
      break;
    case GLFW_KEY_EQUAL:  // + without Shift
    case GLFW_KEY_KP_ADD:
      zoom(0.9f);
      break;
    case GLFW_KEY_MINUS:
    case GLFW_KEY_KP_SUBTRACT:
      zoom(1 / 0.9f);
      break;
    case GLFW_KEY_HOME:
      orbit_.start_at(followed_);
      taken_ = false;
      break;
    case GLFW_KEY_H:
      switches_.help = !switches_.help;
      break;
    case GLFW_KEY_N:
      switches_.numbers = !switches_.numbers;
      break;
    case GLFW_KEY_D:
      switches_.dome = !switches_.dome;
      break;
    case GLFW_KEY_S:
      switches_.shadows = !switches_.shadows;
      break;
    case GLFW_KEY_P:
      switches_.probe = !switches_.probe;
      break;
    case GLFW_KEY_LEFT_BRACKET:
      exposure_steps_ -= kThirdOfAStop;
      break;
    case GLFW_KEY_RIGHT_BRACKET:
      exposure_steps_ += kThirdOfAStop;
      break;
    case GLFW_KEY_C:
      screenshot_ = true;
      break;
    case GLFW_KEY_F:
      toggle_full_screen();
      break;
    default:
      break;
  }
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

void Window::show() {
  glfwSwapBuffers(window_);
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
