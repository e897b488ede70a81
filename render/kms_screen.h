// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <utility>

#include "lighting/result.h"

namespace lightwell::render {

// This machine's own screen without a desktop: the first connected one of the kernel's graphics devices, in its
// preferred mode, all of it, with an OpenGL ES 3.1 context that is current on the calling thread (KMS, GBM, EGL).
// When it goes, the screen shows again what it did before. One at a time.
class KmsScreen {
 public:
  // failed, in one line that says it of every device: none there, none that may be opened, no screen connected, another
  // program has the screen, no OpenGL ES 3.1.
  // folder: where the kernel shows its graphics devices
  static Result<std::unique_ptr<KmsScreen>> open(const std::filesystem::path& folder = "/dev/dri");
  virtual ~KmsScreen() = default;
  [[nodiscard]] virtual std::pair<int, int> size() const = 0;  // in pixels
  // Shows what was drawn, at the screen's next refresh. failed: the screen is gone.
  virtual Status show() = 0;
};

}  // namespace lightwell::render
