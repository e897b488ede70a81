// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "render/dome.h"
#include "render/gl_objects.h"

struct ImDrawData;
struct ImGuiContext;

namespace lightwell::render {

// Text and light markers over a window's picture, laid out by Dear ImGui and drawn with OpenGL ES. Works in the context
// that is current when it is created. What it draws is in no picture file.
class Overlay {
 public:
  struct Content {
    std::vector<std::string> numbers;  // lines in the upper left corner
    std::vector<std::string> help;     // lines in the middle
    std::vector<DomeMarker> markers;
    std::vector<std::vector<Vec2f>> lines;
  };

  static Result<Overlay> create();
  Overlay(Overlay&& other) noexcept;
  Overlay& operator=(Overlay&&) = delete;
  ~Overlay();

  // Into the current framebuffer of this size.
  void draw(const Content& content, int width, int height);

 private:
  Overlay() = default;
  void draw(const ImDrawData& data, int width, int height) const;

  ImGuiContext* context_ = nullptr;
  gl::Program program_;
  gl::Texture font_;
  gl::VertexArray vertex_array_;
  gl::Buffer vertices_;
  gl::Buffer indices_;
};

}  // namespace lightwell::render
