// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <GLES3/gl31.h>

#include "lighting/result.h"

namespace lightwell::render {

// Whether the current OpenGL ES context still lives: a driver that was reset, or a GPU that was taken away, has lost it with
// all its objects, and from then on draws nothing and says so only where it is asked (EXT_robustness, KHR_robustness).
class GraphicsReset {
 public:
  using StatusQuery = GLenum (*)();
  using ErrorQuery = GLenum (*)();

  // Asks the driver of the current context; of one that cannot tell, only its errors.
  GraphicsReset();
  // Asks these; status may be nullptr.
  GraphicsReset(StatusQuery status, ErrorQuery error) : status_(status), error_(error) {}

  // failed: the context is lost, and by whom; or the driver failed otherwise since the last check.
  [[nodiscard]] Status check() const;

 private:
  StatusQuery status_ = nullptr;
  ErrorQuery error_ = nullptr;
};

}  // namespace lightwell::render
