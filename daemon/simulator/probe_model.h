// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "lighting/calibration.h"
#include "lighting/frame_format.h"
#include "lighting/result.h"

namespace lightwell::simulator {

// The simulated camera: what its calibration says, and what no calibration knows.
struct ProbeModel {
  Calibration calibration;  // at the bit depth of `format`
  FrameFormat format;
  double noise_codes = 1;  // temporal noise, standard deviation in codes of a 12 bit camera
  std::uint64_t seed = 0;  // of fixed pattern and noise
};

// A fisheye whose 90° circle just fits the image, with a few per cent of distortion.
Lens default_lens(int width, int height);

// A logarithmic sensor over eight decades and a little more, whose top code lies above `brightest_cd_m2`,
// rounded up to a power of ten so that similar scenes have the same camera. Noise of one code raises the mean
// of what is decoded by exp(σ²/2b²) − 1 = 1.1e-5 of itself: no correction is needed, and up to 20 codes it
// stays below half a per cent.
Response default_response(double brightest_cd_m2, int bits);

// Fixed pattern of a few codes (columns, and pixels on top of them), and vignetting to 63 % at the horizon.
FlatField default_flat_field(int width, int height, int bits, std::uint64_t seed);

}  // namespace lightwell::simulator
