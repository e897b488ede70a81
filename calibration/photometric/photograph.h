// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "interface/jpeg.h"
#include "lighting/result.h"

// A photograph of an ordinary camera, with what the camera wrote about it.
namespace lightwell::calibration {

struct Photograph {
  std::string file;
  std::shared_ptr<const std::string>
      jpeg;  // the file's bytes: decoded, eighteen photographs would not fit into memory
  int full_width = 0, full_height = 0;
  JpegPicture picture;  // mean codes of squares, of those at the far edges what there is
  std::vector<std::uint8_t>
      uneven;  // [height][width] of picture: the square's codes differ by more than by noise
  double exposure_s = 0;
  std::optional<double> exif_exposure_s;  // what the file itself says, also where that was not taken
  std::optional<double> f_number, iso;
};

// JPEG; exposure time, f-number and ISO from its EXIF data. exposure_s: instead of EXIF's, where above 0.
// shrink: the side of a square, 1 or more. bad_input: unreadable, not a JPEG, no exposure time anywhere.
Result<Photograph> read_photograph(const std::filesystem::path& file, double exposure_s, int shrink);

}  // namespace lightwell::calibration
