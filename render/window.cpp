// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

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
  glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int) {
    if (action == GLFW_PRESS && (key == GLFW_KEY_ESCAPE || key == GLFW_KEY_Q))
      glfwSetWindowShouldClose(w, GLFW_TRUE);
  });
  glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) {
    Window& self = *owner(w);
    if (glfwGetMouseButton(w, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS) {
      constexpr float kRadiansPerPixel = 0.006f;
      self.orbit_.turn(static_cast<float>(self.last_x_ - x) * kRadiansPerPixel,
                       static_cast<float>(y - self.last_y_) * kRadiansPerPixel);
      self.changed_ = self.taken_ = true;
    }
    self.last_x_ = x;
    self.last_y_ = y;
  });
  glfwSetScrollCallback(window, [](GLFWwindow* w, double, double dy) {
    owner(w)->orbit_.zoom(static_cast<float>(std::pow(0.9, dy)));
    owner(w)->changed_ = owner(w)->taken_ = true;
  });
  glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int, int) { owner(w)->changed_ = true; });
  glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { owner(w)->changed_ = true; });
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
  if (!taken_) orbit_.start_at(camera);
}

void Window::set_title(const std::string& title) {
  glfwSetWindowTitle(window_, title.c_str());
}

}  // namespace lightwell::render
