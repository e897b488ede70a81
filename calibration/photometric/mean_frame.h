// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibration/photometric/take_frames.h"
#include "lighting/frame_format.h"
#include "lighting/result.h"

namespace lightwell::calibration {

// What frames of one exposure have in common.
struct MeanFrame {
  FrameFormat format;
  std::vector<double> code;   // [height][width], mean over the frames
  std::vector<double> sigma;  // standard deviation over the frames; 0 with one frame
  std::uint64_t frames = 0;
  double exposure_us = 0;
  std::optional<double> temperature_c;  // mean, where the camera has one
  std::string name;                     // the recording, for errors; empty: made otherwise
};

inline constexpr std::size_t kMostExposures = 32;
// Exposures that differ by less than this part are one.
inline constexpr double kOneExposure = 1e-3;

// One for each exposure, in order of appearance. bad_input: not a take, damaged, more than kMostExposures of them.
Result<std::vector<MeanFrame>> mean_frames(TakeFrames& take);
// bad_input, too: frames of different exposure, which have no mean.
Result<MeanFrame> mean_frame(const std::filesystem::path& recording);

// Colour of a pixel of an RGGB mosaic: 0 red, 1 green, 2 blue; 0 for every pixel of a monochrome format.
inline int colour_of(const FrameFormat& format, int x, int y) {
  return is_bayer(format.pixel_format) ? x % 2 + y % 2 : 0;
}

}  // namespace lightwell::calibration
