// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "lighting/calibration.h"
#include "lighting/frame_format.h"

namespace lightwell::test {

// A logarithmic camera of the given size: 26 octaves over its codes, distorted lens, fixed pattern,
// vignetting.
inline Calibration log_camera(int width, int height, int bits, unsigned seed = 1) {
  Calibration c;
  const double side = std::min(width, height);
  c.lens = {{width, height},
            {side / kPi * 0.97, side / kPi * 0.98},
            {(width - 1) / 2.0 + 0.13, (height - 1) / 2.0 - 0.21},
            {-0.01, 0.002, 0, 0},
            kPi / 2};
  const double top = std::ldexp(1.0, bits) - 1;
  const double b = (top + 1) / (26 * std::log(2.0));
  c.response = {LogResponse{5 * b, b, 0}, bits, top * 0.02, top - 3, 10000};
  c.flat.image_size = c.lens.image_size;
  std::mt19937 random(seed);
  std::normal_distribution<float> noise(0, static_cast<float>(top / 400));
  for (int i = 0; i < width * height; ++i) c.flat.offset_codes.push_back(noise(random));
  c.flat.vignetting = {-0.12, 0.01, -0.002};
  return c;
}

// Over all usable codes and two that are clipped.
inline std::vector<std::uint16_t> random_codes(const Calibration& c, const FrameFormat& format,
                                               unsigned seed = 7) {
  std::mt19937 random(seed);
  const int low = static_cast<int>(c.response.black_code);
  std::uniform_int_distribution<int> code(low, static_cast<int>(c.response.clip_code) + 2);
  std::vector<std::uint16_t> codes(static_cast<std::size_t>(format.width) *
                                   static_cast<std::size_t>(format.height));
  for (auto& v : codes) v = static_cast<std::uint16_t>(code(random));
  return codes;
}

}  // namespace lightwell::test
