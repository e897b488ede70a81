// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "lighting/result.h"
#include "render/look.h"

namespace lightwell::render {

// Row 0 at the top, RGBA interleaved.
struct RadiancePicture {
  int width = 0;
  int height = 0;
  std::vector<float> rgba;  // linear Rec. 709, the light's own units; alpha is coverage, colour premultiplied
};

struct DisplayPicture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;  // straight alpha
  Display display = Display::srgb;
};

// Written whole or not at all. failed: folder missing, disk full.
Status write_exr(const std::filesystem::path& file, const RadiancePicture& picture);
Status write_png(const std::filesystem::path& file, const DisplayPicture& picture);

}  // namespace lightwell::render
