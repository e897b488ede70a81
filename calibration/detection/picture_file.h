// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "lighting/result.h"

namespace lightwell::calibration {

// [height][width], 8 bit, as the file encodes brightness.
struct GreyPicture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;
};

// JPEG or PNG, colour made grey. bad_input names the file: missing, another format, truncated, more than 200
// million pixels. A turn noted in the file's Exif part is not applied: a lens belongs to the sensor.
Result<GreyPicture> read_grey_picture(const std::filesystem::path& file);

}  // namespace lightwell::calibration
