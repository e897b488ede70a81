// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "lighting/frame_format.h"

namespace lightwell {

// A V4L2 pixel format that can become one of ours (linux/videodev2.h; Documentation/userspace-api/media/v4l).
struct V4l2Format {
  // How a line lies in memory. mipi10, mipi12, mipi14: the high bytes of 4, 2 or 4 pixels, then their low bits,
  // as CSI-2 sends them. y10b: 10 bits a pixel without gaps, most significant first.
  enum class Packing { plain, big_endian, mipi10, mipi12, mipi14, y10b };

  std::uint32_t fourcc = 0;
  PixelFormat becomes = PixelFormat::mono8;
  Packing packing = Packing::plain;
  // A mosaic that does not begin with red loses its first columns or rows, and as many at the other end, so that
  // it does: pixel coordinates begin at the first red pixel.
  int first_column = 0, first_row = 0;

  [[nodiscard]] FrameFormat frame_format(int width, int height) const {
    return {width - 2 * first_column, height - 2 * first_row, becomes};
  }
  // Bytes of pixels in a line of the device, without its padding.
  [[nodiscard]] std::size_t line_bytes(int width) const;
  // The device's lines are ours but for padding between them.
  [[nodiscard]] bool is_plain() const {
    return packing == Packing::plain && first_column == 0 && first_row == 0;
  }
};

std::span<const V4l2Format> v4l2_formats();  // in order of preference: more bits first, plain before packed
std::optional<V4l2Format> v4l2_format_of(std::uint32_t fourcc);
std::string fourcc_name(std::uint32_t fourcc);  // "Y16", "Y16-BE", as v4l2-ctl prints them but for the blank

// One frame of the device to one of ours.
// lines: height lines, stride bytes apart, the last may end after its pixels; out: frame_format(width, height).bytes()
// allocates nothing
void unpack_v4l2(const V4l2Format& format, int width, int height, std::size_t stride,
                 std::span<const std::byte> lines, std::span<std::byte> out) noexcept;

}  // namespace lightwell
