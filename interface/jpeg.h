// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lighting/result.h"

namespace lightwell {

// A picture for people. rgb: [height][width][3], sRGB; quality 1 to 100. Returns the file's bytes.
Result<std::string> encode_jpeg(int width, int height, std::span<const std::uint8_t> rgb, int quality = 85);

struct JpegPicture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;  // [height][width][3]
};
// bad_input: not a JPEG, truncated, over 2^28 pixels.
Result<JpegPicture> decode_jpeg(std::string_view bytes, const std::string& name_for_errors);

}  // namespace lightwell
