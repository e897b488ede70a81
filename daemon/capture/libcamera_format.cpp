// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/libcamera_format.h"

#include <linux/videodev2.h>

#include <array>

namespace lightwell {
namespace {

constexpr std::uint32_t code(char a, char b, char c, char d) {
  return static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b) << 8 |
         static_cast<std::uint32_t>(c) << 16 | static_cast<std::uint32_t>(d) << 24;
}
constexpr std::uint64_t kCsi2Packed = std::uint64_t{11} << 56 | 1;  // vendor MIPI, drm_fourcc of libcamera

struct Raw {
  std::uint32_t drm;
  std::uint64_t modifier;
  std::uint32_t v4l2;
  bool processed = false;
};
constexpr std::array kRaw = {
    Raw{code('R', '1', '6', ' '), 0, V4L2_PIX_FMT_Y16},
    Raw{code('R', '1', '2', ' '), 0, V4L2_PIX_FMT_Y12},
    Raw{code('R', '1', '2', ' '), kCsi2Packed, v4l2_fourcc('Y', '1', '2', 'P')},
    Raw{code('R', '1', '0', ' '), 0, V4L2_PIX_FMT_Y10},
    Raw{code('R', '1', '0', ' '), kCsi2Packed, V4L2_PIX_FMT_Y10P},
    Raw{code('R', '8', ' ', ' '), 0, V4L2_PIX_FMT_GREY},
    Raw{code('R', 'G', 'B', '6'), 0, V4L2_PIX_FMT_SRGGB16},
    Raw{code('G', 'R', '1', '6'), 0, V4L2_PIX_FMT_SGRBG16},
    Raw{code('G', 'B', '1', '6'), 0, V4L2_PIX_FMT_SGBRG16},
    Raw{code('B', 'Y', 'R', '2'), 0, V4L2_PIX_FMT_SBGGR16},
    Raw{code('R', 'G', '1', '2'), 0, V4L2_PIX_FMT_SRGGB12},
    Raw{code('B', 'A', '1', '2'), 0, V4L2_PIX_FMT_SGRBG12},
    Raw{code('G', 'B', '1', '2'), 0, V4L2_PIX_FMT_SGBRG12},
    Raw{code('B', 'G', '1', '2'), 0, V4L2_PIX_FMT_SBGGR12},
    Raw{code('R', 'G', '1', '2'), kCsi2Packed, V4L2_PIX_FMT_SRGGB12P},
    Raw{code('B', 'A', '1', '2'), kCsi2Packed, V4L2_PIX_FMT_SGRBG12P},
    Raw{code('G', 'B', '1', '2'), kCsi2Packed, V4L2_PIX_FMT_SGBRG12P},
    Raw{code('B', 'G', '1', '2'), kCsi2Packed, V4L2_PIX_FMT_SBGGR12P},
    Raw{code('R', 'G', '1', '0'), 0, V4L2_PIX_FMT_SRGGB10},
    Raw{code('B', 'A', '1', '0'), 0, V4L2_PIX_FMT_SGRBG10},
    Raw{code('G', 'B', '1', '0'), 0, V4L2_PIX_FMT_SGBRG10},
    Raw{code('B', 'G', '1', '0'), 0, V4L2_PIX_FMT_SBGGR10},
    Raw{code('R', 'G', '1', '0'), kCsi2Packed, V4L2_PIX_FMT_SRGGB10P},
    Raw{code('B', 'A', '1', '0'), kCsi2Packed, V4L2_PIX_FMT_SGRBG10P},
    Raw{code('G', 'B', '1', '0'), kCsi2Packed, V4L2_PIX_FMT_SGBRG10P},
    Raw{code('B', 'G', '1', '0'), kCsi2Packed, V4L2_PIX_FMT_SBGGR10P},
    Raw{code('R', 'G', 'G', 'B'), 0, V4L2_PIX_FMT_SRGGB8},
    Raw{code('G', 'R', 'B', 'G'), 0, V4L2_PIX_FMT_SGRBG8},
    Raw{code('G', 'B', 'R', 'G'), 0, V4L2_PIX_FMT_SGBRG8},
    Raw{code('B', 'A', '8', '1'), 0, V4L2_PIX_FMT_SBGGR8},
    // The first plane of these is luma.
    Raw{code('N', 'V', '1', '2'), 0, V4L2_PIX_FMT_GREY, true},
    Raw{code('N', 'V', '2', '1'), 0, V4L2_PIX_FMT_GREY, true},
    Raw{code('Y', 'U', '1', '2'), 0, V4L2_PIX_FMT_GREY, true},
    Raw{code('Y', 'V', '1', '2'), 0, V4L2_PIX_FMT_GREY, true},
};

// DRM names the channels from the highest bit of a little-endian word: RGB888 lies in memory as B, G, R.
struct Colour {
  std::uint32_t drm;
  int bytes, red, green, blue;
};
constexpr std::array kColour = {
    Colour{code('R', 'G', '2', '4'), 3, 2, 1, 0}, Colour{code('B', 'G', '2', '4'), 3, 0, 1, 2},
    Colour{code('X', 'R', '2', '4'), 4, 2, 1, 0}, Colour{code('A', 'R', '2', '4'), 4, 2, 1, 0},
    Colour{code('X', 'B', '2', '4'), 4, 0, 1, 2}, Colour{code('A', 'B', '2', '4'), 4, 0, 1, 2},
};

}  // namespace

std::optional<LibcameraFormat> libcamera_format_of(std::uint32_t fourcc, std::uint64_t modifier) {
  for (const Raw& raw : kRaw) {
    if (raw.drm != fourcc || raw.modifier != modifier) continue;
    LibcameraFormat format;
    format.fourcc = fourcc;
    format.modifier = modifier;
    format.codes = *v4l2_format_of(raw.v4l2);
    format.processed = raw.processed;
    return format;
  }
  for (const Colour& colour : kColour) {
    if (colour.drm != fourcc || modifier != 0) continue;
    LibcameraFormat format;
    format.fourcc = fourcc;
    format.bytes_per_pixel = colour.bytes;
    format.red = colour.red;
    format.green = colour.green;
    format.blue = colour.blue;
    format.processed = true;
    return format;
  }
  return std::nullopt;
}

void unpack_libcamera(const LibcameraFormat& format, int width, int height, std::size_t stride,
                      std::span<const std::byte> lines, std::span<std::byte> out) noexcept {
  if (format.bytes_per_pixel == 0) return unpack_v4l2(format.codes, width, height, stride, lines, out);
  const auto columns = static_cast<std::size_t>(width),
             step = static_cast<std::size_t>(format.bytes_per_pixel);
  for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
    const std::byte* line = lines.data() + y * stride;
    const std::array<int, 2> channel = {y % 2 == 0 ? format.red : format.green,
                                        y % 2 == 0 ? format.green : format.blue};
    for (std::size_t x = 0; x < columns; ++x)
      out[y * columns + x] = line[x * step + static_cast<std::size_t>(channel[x % 2])];
  }
}

}  // namespace lightwell
