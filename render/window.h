// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "lighting/result.h"
#include "render/camera.h"

struct GLFWwindow;

namespace lightwell::render {

// A window with an OpenGL ES 3.1 context, current on the calling thread. Dragging turns the camera, the wheel
// zooms, Esc and q close. One at a time, on the main thread.
class Window {
 public:
  // failed: no display, or none with OpenGL ES 3.1.
  static Result<std::unique_ptr<Window>> open(int width, int height, Orbit orbit);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  // Handles what happened since the last call, waiting up to wait_s for something to happen.
  void poll(double wait_s = 0);
  void show();  // swaps buffers
  [[nodiscard]] bool closed() const;
  // In pixels; {0, 0} while minimised.
  [[nodiscard]] std::pair<int, int> size() const;
  // True once after the camera moved or the window changed size or was uncovered.
  [[nodiscard]] bool take_changed();
  [[nodiscard]] SceneCamera camera() const;
  // The camera stands there, until a user moves it.
  void follow(const SceneCamera& camera);
  void set_title(const std::string& title);
  [[nodiscard]] GLFWwindow* handle() const { return window_; }

 private:
  Window(GLFWwindow* window, Orbit orbit);
  GLFWwindow* window_ = nullptr;
  Orbit orbit_;
  bool changed_ = true;
  bool taken_ = false;  // a user moved the camera
  double last_x_ = 0;
  double last_y_ = 0;
};

}  // namespace lightwell::render
