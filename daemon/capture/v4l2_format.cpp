// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/v4l2_format.h"

#include <linux/videodev2.h>

#include <array>
#include <cstring>

namespace lightwell {
namespace {

using Packing = V4l2Format::Packing;

// Newer than Debian 12's headers.
constexpr std::uint32_t kY12p = v4l2_fourcc('Y', '1', '2', 'P');
constexpr std::uint32_t kY14p = v4l2_fourcc('Y', '1', '4', 'P');
constexpr std::uint32_t kRggb14 = v4l2_fourcc('R', 'G', '1', '4');

// 14 bits travel as 16 whose highest codes do not occur.
constexpr std::array kFormats = {
    V4l2Format{V4L2_PIX_FMT_Y16, PixelFormat::mono16},
    V4l2Format{V4L2_PIX_FMT_Y16_BE, PixelFormat::mono16, Packing::big_endian},
    V4l2Format{V4L2_PIX_FMT_Y14, PixelFormat::mono16},
    V4l2Format{kY14p, PixelFormat::mono16, Packing::mipi14},
    V4l2Format{V4L2_PIX_FMT_SRGGB16, PixelFormat::bayer_rg16},
    V4l2Format{V4L2_PIX_FMT_SGRBG16, PixelFormat::bayer_rg16, Packing::plain, 1, 0},
    V4l2Format{V4L2_PIX_FMT_SGBRG16, PixelFormat::bayer_rg16, Packing::plain, 0, 1},
    V4l2Format{V4L2_PIX_FMT_SBGGR16, PixelFormat::bayer_rg16, Packing::plain, 1, 1},
    V4l2Format{kRggb14, PixelFormat::bayer_rg16},
    V4l2Format{V4L2_PIX_FMT_Y12, PixelFormat::mono12},
    V4l2Format{kY12p, PixelFormat::mono12, Packing::mipi12},
    V4l2Format{V4L2_PIX_FMT_SRGGB12, PixelFormat::bayer_rg12},
    V4l2Format{V4L2_PIX_FMT_SGRBG12, PixelFormat::bayer_rg12, Packing::plain, 1, 0},
    V4l2Format{V4L2_PIX_FMT_SGBRG12, PixelFormat::bayer_rg12, Packing::plain, 0, 1},
    V4l2Format{V4L2_PIX_FMT_SBGGR12, PixelFormat::bayer_rg12, Packing::plain, 1, 1},
    V4l2Format{V4L2_PIX_FMT_SRGGB12P, PixelFormat::bayer_rg12, Packing::mipi12},
    V4l2Format{V4L2_PIX_FMT_SGRBG12P, PixelFormat::bayer_rg12, Packing::mipi12, 1, 0},
    V4l2Format{V4L2_PIX_FMT_SGBRG12P, PixelFormat::bayer_rg12, Packing::mipi12, 0, 1},
    V4l2Format{V4L2_PIX_FMT_SBGGR12P, PixelFormat::bayer_rg12, Packing::mipi12, 1, 1},
    V4l2Format{V4L2_PIX_FMT_Y10, PixelFormat::mono10},
    V4l2Format{V4L2_PIX_FMT_Y10P, PixelFormat::mono10, Packing::mipi10},
    V4l2Format{V4L2_PIX_FMT_Y10BPACK, PixelFormat::mono10, Packing::y10b},
    V4l2Format{V4L2_PIX_FMT_SRGGB10, PixelFormat::bayer_rg10},
    V4l2Format{V4L2_PIX_FMT_SGRBG10, PixelFormat::bayer_rg10, Packing::plain, 1, 0},
    V4l2Format{V4L2_PIX_FMT_SGBRG10, PixelFormat::bayer_rg10, Packing::plain, 0, 1},
    V4l2Format{V4L2_PIX_FMT_SBGGR10, PixelFormat::bayer_rg10, Packing::plain, 1, 1},
    V4l2Format{V4L2_PIX_FMT_SRGGB10P, PixelFormat::bayer_rg10, Packing::mipi10},
    V4l2Format{V4L2_PIX_FMT_SGRBG10P, PixelFormat::bayer_rg10, Packing::mipi10, 1, 0},
    V4l2Format{V4L2_PIX_FMT_SGBRG10P, PixelFormat::bayer_rg10, Packing::mipi10, 0, 1},
    V4l2Format{V4L2_PIX_FMT_SBGGR10P, PixelFormat::bayer_rg10, Packing::mipi10, 1, 1},
    V4l2Format{V4L2_PIX_FMT_GREY, PixelFormat::mono8},
    V4l2Format{V4L2_PIX_FMT_SRGGB8, PixelFormat::bayer_rg8},
    V4l2Format{V4L2_PIX_FMT_SGRBG8, PixelFormat::bayer_rg8, Packing::plain, 1, 0},
    V4l2Format{V4L2_PIX_FMT_SGBRG8, PixelFormat::bayer_rg8, Packing::plain, 0, 1},
    V4l2Format{V4L2_PIX_FMT_SBGGR8, PixelFormat::bayer_rg8, Packing::plain, 1, 1},
};

unsigned at(const std::byte* line, std::size_t i) {
  return static_cast<unsigned>(line[i]);
}

// The code of pixel x of a packed line.
template <Packing packing>
unsigned code(const std::byte* line, std::size_t x) {
  if constexpr (packing == Packing::big_endian) return at(line, 2 * x) << 8 | at(line, 2 * x + 1);
  if constexpr (packing == Packing::mipi10) {
    const std::byte* group = line + x / 4 * 5;
    return at(group, x % 4) << 2 | (at(group, 4) >> 2 * (x % 4) & 3);
  }
  if constexpr (packing == Packing::mipi12) {
    const std::byte* group = line + x / 2 * 3;
    return at(group, x % 2) << 4 | (at(group, 2) >> 4 * (x % 2) & 15);
  }
  if constexpr (packing == Packing::mipi14) {
    const std::byte* group = line + x / 4 * 7;
    const unsigned low = at(group, 4) | at(group, 5) << 8 | at(group, 6) << 16;
    return at(group, x % 4) << 6 | (low >> 6 * (x % 4) & 63);
  }
  const std::size_t first = 10 * x;  // bit, of a stream whose bytes begin at their highest
  const unsigned two = at(line, first / 8) << 8 | at(line, first / 8 + 1);
  return two >> (6 - first % 8) & 1023;
}

template <Packing packing>
void unpack_line(const std::byte* line, std::size_t first, std::span<std::byte> out) {
  for (std::size_t x = 0; x < out.size() / 2; ++x) {
    const auto value = static_cast<std::uint16_t>(code<packing>(line, first + x));
    std::memcpy(&out[2 * x], &value, sizeof value);
  }
}

}  // namespace

std::size_t V4l2Format::line_bytes(int width) const {
  const auto pixels = static_cast<std::size_t>(width);
  switch (packing) {
    case Packing::plain:
    case Packing::big_endian:
      return pixels * static_cast<std::size_t>(storage_bits(becomes)) / 8;
    case Packing::mipi10:
      return (pixels + 3) / 4 * 5;
    case Packing::mipi12:
      return (pixels + 1) / 2 * 3;
    case Packing::mipi14:
      return (pixels + 3) / 4 * 7;
    case Packing::y10b:
      return (10 * pixels + 7) / 8;
  }
  return 0;
}

std::span<const V4l2Format> v4l2_formats() {
  return kFormats;
}

std::optional<V4l2Format> v4l2_format_of(std::uint32_t fourcc) {
  for (const V4l2Format& format : kFormats)
    if (format.fourcc == fourcc) return format;
  return std::nullopt;
}

std::string fourcc_name(std::uint32_t fourcc) {
  std::string text;
  for (int shift = 0; shift < 32; shift += 8) {
    const auto c = static_cast<char>(fourcc >> shift & 127);
    text += c > ' ' && c < 127 ? c : ' ';
  }
  text.erase(text.find_last_not_of(' ') + 1);
  return fourcc >> 31 != 0 ? text + "-BE" : text;
}

void unpack_v4l2(const V4l2Format& format, int width, int height, std::size_t stride,
                 std::span<const std::byte> lines, std::span<std::byte> out) noexcept {
  const FrameFormat frame = format.frame_format(width, height);
  const auto rows = static_cast<std::size_t>(frame.height);
  const std::size_t row_bytes = frame.bytes() / rows;
  const auto first = static_cast<std::size_t>(format.first_column);
  for (std::size_t y = 0; y < rows; ++y) {
    const std::byte* line = lines.data() + (y + static_cast<std::size_t>(format.first_row)) * stride;
    const auto row = out.subspan(y * row_bytes, row_bytes);
    switch (format.packing) {
      case Packing::plain:
        std::memcpy(row.data(), line + first * row_bytes / static_cast<std::size_t>(frame.width), row_bytes);
        break;
      case Packing::big_endian:
        unpack_line<Packing::big_endian>(line, first, row);
        break;
      case Packing::mipi10:
        unpack_line<Packing::mipi10>(line, first, row);
        break;
      case Packing::mipi12:
        unpack_line<Packing::mipi12>(line, first, row);
        break;
      case Packing::mipi14:
        unpack_line<Packing::mipi14>(line, first, row);
        break;
      case Packing::y10b:
        unpack_line<Packing::y10b>(line, first, row);
        break;
    }
  }
}

}  // namespace lightwell
