// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "interface/rig_file.h"
#include "lighting/lat_long_image.h"
#include "lighting/luminaire/luminaire.h"
#include "lighting/luminaire/measured_lamp.h"

namespace lightwell::calibration {

// A lamp from a rig's pictures of the measurement plane: response, dark frame, rectification, resampling by area, the
// slides' scale.
struct BuiltLamp {
  MeasuredLamp measured;  // at the pixels' middles
  Luminaire lamp;         // its point sources
  std::array<int, 2> picture_size = {0, 0};
  double mark_rms_px = 0;
  std::size_t completed = 0;     // positions without a picture, made of their neighbours
  double most_saturated = 0;     // part of the pixels, of the worst picture
  double most_negative = 0;      // negative light of a picture over the brightest one's
  double largest_deviation = 0;  // of a position from the grid, in spacings
  double scale = 1;              // by the reference
  std::vector<std::string> remarks;
};

// A picture of the rig's by its name in positions.csv, or its dark frame. Values as they are in the file.
using RigPictures = std::function<Result<LatLongImage>(const std::string& file)>;
RigPictures exr_pictures(const std::filesystem::path& folder);

// folder: where the rig's calibration is, and for names in errors. progress: may be empty.
// bad_input: a picture that cannot be read, of another size, with pixels that are no numbers, too many saturated ones or too
// much negative light, or that does not show all of the measurement plane; marks, positions and calibration as their
// readers say. Names file, line, field, value and range.
Result<BuiltLamp> build_lamp(const Rig& rig, const std::filesystem::path& folder, const RigPictures& pictures,
                             const std::function<void(std::size_t done, std::size_t all)>& progress = {});

}  // namespace lightwell::calibration
