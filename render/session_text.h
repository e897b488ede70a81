// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace lightwell::render {

// What a window tells of the light and of its work.
struct ViewNumbers {
  double fps = 0;
  double frame_ms = 0;  // from light and camera to the finished picture
  std::size_t lights = 0;
  std::size_t shadow_maps = 0;
  int shadow_size = 0;
  bool light_arrived = true;
  std::optional<std::chrono::nanoseconds> light_age;  // of live light
  double predicted_error = 0;                         // of the lights' shadows; 0: they carry none
  double expected_error = 0;  // of the picture, where a frame rate is kept; 0: none is
  double ev100 = 0;
  bool ev_by_hand = false;
};

std::string title_text(const ViewNumbers& n);
std::vector<std::string> overlay_text(const ViewNumbers& n);

// Of objects whose shadows are lost (Renderer::lost_shadows).
std::string lost_shadows_text(const std::string& scene, std::size_t objects, std::size_t of, float texel_m,
                              float span_m);
std::string plate_white_text(const std::string& plate, float white_cd_m2);

}  // namespace lightwell::render
