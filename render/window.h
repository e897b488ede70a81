// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "lighting/result.h"
#include "render/camera.h"

struct GLFWwindow;

namespace lightwell::render {

// What keys of a window switch.
struct WindowSwitches {
  bool help = false;
  bool numbers = true;
  bool dome = false;
  bool shadows = true;
  bool lists_the_other_way = false;  // than asked for
  bool probe = false;
};

// A window with an OpenGL ES 3.1 context, current on the calling thread. Dragging turns the camera, or moves it with the
// right button, the wheel zooms; keys: help_lines(). One at a time, on the main thread.
class Window {
 public:
  // failed: no display, or none with OpenGL ES 3.1.
  static Result<std::unique_ptr<Window>> open(int width, int height, Orbit orbit);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  // Handles what happened since the last call, waiting up to wait_s for something to happen.
  void poll(double wait_s = 0);
  Status show();  // swaps buffers; failed: the context is lost
  [[nodiscard]] bool closed() const;
  // In pixels; {0, 0} while minimised.
  [[nodiscard]] std::pair<int, int> size() const;
  // True once after the camera moved or the window changed size or was uncovered.
  [[nodiscard]] bool take_changed();
  // True once after a key for what lies over the picture alone.
  [[nodiscard]] bool take_overlay_changed() { return std::exchange(overlay_changed_, false); }
  [[nodiscard]] SceneCamera camera() const;
  // The camera stands there, until a user moves it.
  void follow(const SceneCamera& camera);
  void set_title(const std::string& title);
  [[nodiscard]] const WindowSwitches& switches() const { return switches_; }
  // True once after the key for it.
  [[nodiscard]] bool take_screenshot() { return std::exchange(screenshot_, false); }
  // Stops brighter that keys asked for since the last call.
  [[nodiscard]] double take_exposure_steps() { return std::exchange(exposure_steps_, 0.0); }
  // What each key does, a line each.
  static std::vector<std::string> help_lines();
  [[nodiscard]] GLFWwindow* handle() const { return window_; }

 private:
  Window(GLFWwindow* window, Orbit orbit);
  struct Key;
  static std::span<const Key> keys();
  void press(int key);
  void turn(float right, float up);
  void zoom(float factor);
  void expose(double stops);
  // Of the picture, or of what lies over it alone.
  void switch_picture(bool WindowSwitches::*what);
  void switch_overlay(bool WindowSwitches::*what);
  void go_home();
  void drag(double x, double y);
  void toggle_full_screen();
  GLFWwindow* window_ = nullptr;
  Orbit orbit_;
  bool changed_ = true;
  bool overlay_changed_ = false;
  bool taken_ = false;  // a user moved the camera
  WindowSwitches switches_;
  bool screenshot_ = false;
  double exposure_steps_ = 0;
  SceneCamera followed_;                // where the camera would stand without a user
  int windowed_[4] = {0, 0, 640, 480};  // place and size to return to from full screen
  double last_x_ = 0;
  double last_y_ = 0;
};

}  // namespace lightwell::render
