// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "lighting/result.h"

namespace lightwell::render {

// An OpenGL ES 3.1 context without a window or a display server, current on the calling thread while it
// lives.
class EglContext {
 public:
  // failed: no EGL driver, or none with OpenGL ES 3.1.
  static Result<EglContext> create();
  EglContext(EglContext&& other) noexcept;
  EglContext& operator=(EglContext&& other) noexcept;
  ~EglContext();

 private:
  EglContext(void* display, void* context) : display_(display), context_(context) {}
  void* display_ = nullptr;
  void* context_ = nullptr;
};

}  // namespace lightwell::render
