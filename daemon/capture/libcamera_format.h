// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "daemon/capture/v4l2_format.h"

namespace lightwell {

// A libcamera pixel format (a DRM fourcc and modifier) that can become one of ours. Raw formats are V4L2's under other
// names. A processed colour stream becomes the mosaic a sensor would have sent, one channel of each pixel; a processed
// YUV stream its luma. What processing did to the codes is for whoever set it up to know.
struct LibcameraFormat {
  std::uint32_t fourcc = 0;
  std::uint64_t modifier = 0;
  V4l2Format codes;                  // of raw and luma
  int bytes_per_pixel = 0;           // of processed colour; 0: raw or luma
  int red = 0, green = 0, blue = 0;  // byte in a pixel
  bool processed = false;

  [[nodiscard]] FrameFormat frame_format(int width, int height) const {
    return bytes_per_pixel > 0 ? FrameFormat{width, height, PixelFormat::bayer_rg8}
                               : codes.frame_format(width, height);
  }
  [[nodiscard]] std::size_t line_bytes(int width) const {
    return bytes_per_pixel > 0 ? static_cast<std::size_t>(width * bytes_per_pixel) : codes.line_bytes(width);
  }
  [[nodiscard]] bool is_plain() const { return bytes_per_pixel == 0 && codes.is_plain(); }
};

std::optional<LibcameraFormat> libcamera_format_of(std::uint32_t fourcc, std::uint64_t modifier);

// As unpack_v4l2. allocates nothing
void unpack_libcamera(const LibcameraFormat& format, int width, int height, std::size_t stride,
                      std::span<const std::byte> lines, std::span<std::byte> out) noexcept;

}  // namespace lightwell
