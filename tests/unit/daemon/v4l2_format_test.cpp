// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/v4l2_format.h"

#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <cstring>
#include <set>
#include <vector>

namespace lightwell {
namespace {

constexpr int kWidth = 10, kHeight = 6;  // no whole number of groups of four
constexpr std::size_t kPadding = 3;

unsigned bits_of(V4l2Format::Packing packing, PixelFormat becomes) {
  switch (packing) {
    case V4l2Format::Packing::mipi10:
    case V4l2Format::Packing::y10b:
      return 10;
    case V4l2Format::Packing::mipi12:
      return 12;
    case V4l2Format::Packing::mipi14:
      return 14;
    default:
      return static_cast<unsigned>(significant_bits(becomes));
  }
}

// Every pixel has another code, with all bits in use.
unsigned code_at(int x, int y, unsigned bits) {
  const auto mixed = static_cast<unsigned>(x * 7919 + y * 104729 + 12345) * 2654435761U;
  return mixed >> (32 - bits);
}

void set_bit(std::vector<std::byte>& bytes, std::size_t bit, bool most_significant_first) {
  bytes[bit / 8] |= std::byte{1} << (most_significant_first ? 7 - bit % 8 : bit % 8);
}

// The line as Documentation/userspace-api/media/v4l/pixfmt-*.rst has it, bit by bit.
std::vector<std::byte> packed_line(const V4l2Format& format, int y) {
  using Packing = V4l2Format::Packing;
  const unsigned bits = bits_of(format.packing, format.becomes);
  std::vector<std::byte> line(format.line_bytes(kWidth));
  const std::size_t group = bits == 12 ? 2 : 4;
  for (int x = 0; x < kWidth; ++x) {
    const auto i = static_cast<std::size_t>(x);
    const unsigned code = code_at(x, y, bits);
    for (unsigned b = 0; b < bits; ++b) {
      if ((code >> b & 1) == 0) continue;
      const std::size_t word = static_cast<std::size_t>(storage_bits(format.becomes));
      if (format.packing == Packing::plain) {
        set_bit(line, word * i + b, false);
      } else if (format.packing == Packing::big_endian) {
        set_bit(line, word * i + 15 - b, true);
      } else if (format.packing == Packing::y10b) {
        set_bit(line, bits * i + bits - 1 - b, true);
      } else {
        // High bytes of the group's pixels, then their low bits from the lowest bit on.
        const std::size_t base = i / group * group * bits, low = bits - 8;
        const std::size_t at = b >= low ? 8 * (i % group) + b - low : 8 * group + low * (i % group) + b;
        set_bit(line, base + at, false);
      }
    }
  }
  return line;
}

TEST(V4l2Format, EveryFormatUnpacksToTheCodesThatWerePacked) {
  for (const V4l2Format& format : v4l2_formats()) {
    SCOPED_TRACE(fourcc_name(format.fourcc));
    const std::size_t stride = format.line_bytes(kWidth) + kPadding;
    std::vector<std::byte> lines;
    for (int y = 0; y < kHeight; ++y) {
      const auto line = packed_line(format, y);
      lines.insert(lines.end(), line.begin(), line.end());
      if (y + 1 < kHeight) lines.insert(lines.end(), kPadding, std::byte{0xee});  // none behind the last
    }
    const FrameFormat frame = format.frame_format(kWidth, kHeight);
    std::vector<std::byte> out(frame.bytes());
    unpack_v4l2(format, kWidth, kHeight, stride, lines, out);
    for (int y = 0; y < frame.height; ++y) {
      for (int x = 0; x < frame.width; ++x) {
        const auto pixel = static_cast<std::size_t>(y * frame.width + x);
        unsigned got = 0;
        if (storage_bits(format.becomes) == 8) {
          got = static_cast<unsigned>(out[pixel]);
        } else {
          std::uint16_t word = 0;
          std::memcpy(&word, &out[2 * pixel], sizeof word);
          got = word;
        }
        ASSERT_EQ(got, code_at(x + format.first_column, y + format.first_row,
                               bits_of(format.packing, format.becomes)))
            << x << ", " << y;
      }
    }
  }
}

// GRBG has red one column in, GBRG one row down, BGGR both.
TEST(V4l2Format, EveryMosaicBeginsWithRed) {
  const std::vector<std::pair<std::uint32_t, const char*>> orders = {
      {V4L2_PIX_FMT_SRGGB8, "RGGB"},   {V4L2_PIX_FMT_SGRBG8, "GRBG"},   {V4L2_PIX_FMT_SGBRG8, "GBRG"},
      {V4L2_PIX_FMT_SBGGR8, "BGGR"},   {V4L2_PIX_FMT_SRGGB10, "RGGB"},  {V4L2_PIX_FMT_SGRBG10, "GRBG"},
      {V4L2_PIX_FMT_SGBRG10, "GBRG"},  {V4L2_PIX_FMT_SBGGR10, "BGGR"},  {V4L2_PIX_FMT_SRGGB10P, "RGGB"},
      {V4L2_PIX_FMT_SGRBG10P, "GRBG"}, {V4L2_PIX_FMT_SGBRG10P, "GBRG"}, {V4L2_PIX_FMT_SBGGR10P, "BGGR"},
      {V4L2_PIX_FMT_SRGGB12, "RGGB"},  {V4L2_PIX_FMT_SGRBG12, "GRBG"},  {V4L2_PIX_FMT_SGBRG12, "GBRG"},
      {V4L2_PIX_FMT_SBGGR12, "BGGR"},  {V4L2_PIX_FMT_SRGGB12P, "RGGB"}, {V4L2_PIX_FMT_SGRBG12P, "GRBG"},
      {V4L2_PIX_FMT_SGBRG12P, "GBRG"}, {V4L2_PIX_FMT_SBGGR12P, "BGGR"}, {V4L2_PIX_FMT_SRGGB16, "RGGB"},
      {V4L2_PIX_FMT_SGRBG16, "GRBG"},  {V4L2_PIX_FMT_SGBRG16, "GBRG"},  {V4L2_PIX_FMT_SBGGR16, "BGGR"}};
  for (const auto& [fourcc, order] : orders) {
    const auto format = v4l2_format_of(fourcc);
    ASSERT_TRUE(format) << fourcc_name(fourcc);
    EXPECT_TRUE(is_bayer(format->becomes));
    EXPECT_EQ(order[2 * format->first_row + format->first_column], 'R') << fourcc_name(fourcc);
  }
}

TEST(V4l2Format, FourccsAreDistinctAndPlainComesBeforePacked) {
  std::set<std::uint32_t> seen;
  std::set<PixelFormat> packed;
  for (const V4l2Format& format : v4l2_formats()) {
    EXPECT_TRUE(seen.insert(format.fourcc).second) << fourcc_name(format.fourcc);
    EXPECT_FALSE(format.is_plain() && packed.contains(format.becomes)) << fourcc_name(format.fourcc);
    if (!format.is_plain() && significant_bits(format.becomes) < 16)  // where 14 bits stand beside 16
      packed.insert(format.becomes);
  }
  EXPECT_FALSE(v4l2_format_of(V4L2_PIX_FMT_YUYV));
  EXPECT_FALSE(v4l2_format_of(0));
}

TEST(V4l2Format, NamesAreThoseOfTheTools) {
  EXPECT_EQ(fourcc_name(V4L2_PIX_FMT_Y16), "Y16");
  EXPECT_EQ(fourcc_name(V4L2_PIX_FMT_Y16_BE), "Y16-BE");
  EXPECT_EQ(fourcc_name(V4L2_PIX_FMT_SRGGB10P), "pRAA");
}

}  // namespace
}  // namespace lightwell
