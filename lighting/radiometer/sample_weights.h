// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lighting/calibration.h"
#include "lighting/radiometer/cells.h"
#include "lighting/radiometer/pixel_bins.h"

namespace lightwell::radiometer {

// What stands between a pixel's code and its share of its bin, for every pixel of the field in the layout of
// the decoder's tables: mono [rows][stride]; Bayer [rows][2][2 · stride], the two rows of the quads after
// each other.
struct SampleWeights {
  std::vector<float>
      weight_sr;  // solid angle ÷ (vignetting · gain): ideal radiance × this is the pixel's energy; 0: none
  std::vector<float> offset_codes;   // to subtract from the code
  std::vector<std::uint32_t> group;  // of PixelBins
  // Σ weight of the bin's pixels, per channel: what a constant subtracted from every pixel costs the bin.
  std::array<std::vector<double>, 3> bin_weight_sr;
};

// In a quad red and blue stand for the whole quad's solid angle, each green for half. At the odd border of an
// image the colours that a quad lacks come from the pixels of the same colour two columns or rows before.
SampleWeights weigh_samples(const Calibration& calibration, const PixelBins& bins, const CellPlan& plan,
                            bool bayer);

// Pixel that a position of the mosaic takes its code from: itself, or two before it at an odd border.
inline int source_pixel(int position, int size) {
  return position < size ? position : position - 2;
}

}  // namespace lightwell::radiometer
