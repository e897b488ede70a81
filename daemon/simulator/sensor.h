// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "daemon/simulator/probe_model.h"

namespace lightwell::simulator {

// Radiance to raw codes: vignetting, exposure, response, fixed pattern, temporal noise, rounding to the
// nearest code, clipping at 0 and at the largest code.
class Sensor {
 public:
  explicit Sensor(const ProbeModel& model);

  // plane: [height][width] cd/m², ≥ 0; format: of the model's size, any bit depth; out: format.bytes().
  // The noise of a frame depends on the seed and on frame_index alone.
  void encode(std::span<const float> plane, double exposure_us, std::uint64_t frame_index, PixelFormat format,
              std::span<std::byte> out);

 private:
  void encode_row(std::size_t begin, std::size_t count, double exposure_us, std::uint64_t frame_index,
                  std::span<const float> plane);

  ProbeModel model_;
  Response response_;                // at the bit depth of the last frame
  std::vector<float> transmission_;  // of each pixel
  std::vector<float> offset_;        // of each pixel, codes of model_'s bit depth
  std::vector<float> noise_;         // standard normal values; a row starts anywhere in it
  std::vector<std::uint16_t> codes_;
};

// Codes into the bytes of a format: 8 bit, 16 bit little-endian words, or 12 bits packed from the least
// significant on.
void pack_codes(std::span<const std::uint16_t> codes, PixelFormat format, std::span<std::byte> out);

}  // namespace lightwell::simulator
