// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lighting/lens.h"
#include "lighting/polar_map.h"
#include "lighting/result.h"

namespace lightwell::radiometer {

inline constexpr std::uint32_t kNone = 0xffffffff;

// Which bin of the map each sample of the image feeds, and with what solid angle. A sample is a pixel, or a
// quad of 2 × 2 pixels of a Bayer mosaic (rounded up where the image is odd). It belongs to the bin its
// centre looks into, whole: energy is moved by half a pixel at most and never divided or lost.
struct PixelBins {
  int width = 0;  // in samples
  int height = 0;
  // [height][width], kNone outside the field. A group is a bin, or those of its samples that the border of
  // the field leaves less than a quarter of the bin's largest: they are decoded with a scale of their own, as
  // sixteen bits hold only so many octaves. Group b < bins is bin b.
  std::vector<std::uint32_t> group;
  std::vector<std::uint32_t> bin_of_group;
  std::vector<float> solid_angle_sr;  // [height][width], 0 outside the field
  std::vector<double> bin_sr;         // [bins], sum over the bin's samples
  // [bins], for a bin without samples the sample nearest its centre; else kNone
  std::vector<std::uint32_t> nearest;
  double total_sr = 0;
};

// The field is that of the lens or of the grid, whichever ends first. Fails where no pixel of the image sees
// it.
Result<PixelBins> bin_pixels(const Lens& lens, const PolarGrid& grid, bool quads);

}  // namespace lightwell::radiometer
