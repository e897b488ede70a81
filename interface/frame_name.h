// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "lighting/result.h"

namespace lightwell {

// "name_%04d.exr": where a frame's picture goes. Without a number the name holds the last frame of a run.
struct FrameName {
  enum class Format { exr, png } format = Format::exr;
  std::string before;
  std::string after;
  bool numbered = false;
  int digits = 0;

  [[nodiscard]] std::filesystem::path file(int frame) const;
  // usage: another ending than .exr or .png, more than one number, a number that is not %d or %0Nd.
  static Result<FrameName> parse(const std::string& pattern);
};

}  // namespace lightwell
