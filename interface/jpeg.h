// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "lighting/result.h"

namespace lightwell {

// A picture for people. rgb: [height][width][3], sRGB; quality 1 to 100. Returns the file's bytes.
Result<std::string> encode_jpeg(int width, int height, std::span<const std::uint8_t> rgb, int quality = 85);

}  // namespace lightwell
