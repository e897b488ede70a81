// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lighting/result.h"
#include "lighting/vector.h"

namespace lightwell::render {

// What a real camera saw, behind the objects. Row 0 at the top.
struct Plate {
  int width = 0;
  int height = 0;
  std::vector<Rgb> pixels;        // [height][width], linear Rec. 709, finite, ≥ 0
  bool display_referred = false;  // graded: values are a display's light, 1 is its white; else radiance
  std::string remark;             // what was read as 0; empty: nothing
};

// OpenEXR (linear, as read_exr has it; radiance), PNG of 8 or 16 bits and JPEG (sRGB, made linear; what is transparent
// is black; graded).
// bad_input: missing, truncated, another format, over 2^28 pixels.
Result<Plate> read_plate(const std::filesystem::path& file);
Result<Plate> plate_from_bytes(std::string_view bytes, const std::string& name_for_errors);

// IEC 61966-2-1: code in [0, 1] to linear.
float linear_from_srgb(float code);

// The plates of a run: one still picture, or a numbered sequence, of which frame i shows the i-th file. After its end
// the last one stays.
class PlateSource {
 public:
  // bad_input: no file, a gap in the sequence
  // graded: says what the files' formats do not
  static Result<PlateSource> open(const std::string& pattern, std::optional<bool> graded = std::nullopt);
  // Reads the plate of a frame; true where it differs from the one before. bad_input: the file.
  Result<bool> update(int frame);
  [[nodiscard]] const Plate& plate() const { return plate_; }
  [[nodiscard]] const std::filesystem::path& file() const { return files_[static_cast<std::size_t>(shown_)]; }

 private:
  std::vector<std::filesystem::path> files_;
  std::optional<bool> graded_;
  int shown_ = -1;
  Plate plate_;
};

}  // namespace lightwell::render
