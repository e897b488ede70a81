// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lighting/result.h"
#include "render/renderer.h"

namespace lightwell::render {

// What --stats reports of a run (keys: docs and the command's help).
struct Statistics {
  struct Frame {
    double ms = 0;      // wall time from light and camera to the finished picture
    double cpu_ms = 0;  // processor time of the whole program in it
    PassTimes passes;
  };
  std::vector<Frame> frames;
  std::size_t lights = 0;
  std::size_t shadow_maps = 0;
  int shadow_size = 0;
  std::size_t triangles = 0;
  float predicted_error = 0;  // of the last lights' shadows; 0: they carry no prediction
  // What --target-fps chose for the last frame.
  struct Chosen {
    double shadow_texels = 1;   // share of those that the maps' size asks for
    double expected_error = 0;  // relative RMSE of the picture
  };
  std::optional<Chosen> chosen;
  // Of a light field.
  struct Field {
    std::array<int, 3> size{};
    int degree = 0;
    std::size_t main_lights = 0;
    int texture_units = 0;  // that its shading binds
    std::size_t bytes = 0;  // of its textures
    std::size_t balls = 0;
    // Fields that were shown, and how long each took: main lights and upload.
    std::vector<double> update_ms;
  };
  std::optional<Field> field;
  std::optional<LampShading::Counts> lamps;  // of the last frame
  std::string gl_renderer;

  // Passes are medians. A run without frames reports nulls.
  [[nodiscard]] std::string json() const;
};

// Of the field that is set.
Statistics::Field field_statistics(const Renderer& renderer);

}  // namespace lightwell::render
