// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/libcamera_format.h"

#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <array>
#include <vector>

namespace lightwell {
namespace {

constexpr std::uint64_t kCsi2Packed = std::uint64_t{11} << 56 | 1;

TEST(LibcameraFormat, RawFormatsAreThoseOfV4l2) {
  const std::vector<std::array<std::uint32_t, 2>> pairs = {
      {v4l2_fourcc('R', '8', ' ', ' '), V4L2_PIX_FMT_GREY},
      {v4l2_fourcc('R', '1', '2', ' '), V4L2_PIX_FMT_Y12},
      {v4l2_fourcc('R', 'G', '1', '0'), V4L2_PIX_FMT_SRGGB10},
      {v4l2_fourcc('R', 'G', 'B', '6'), V4L2_PIX_FMT_SRGGB16}};
  for (const auto& [drm, v4l2] : pairs) {
    const auto format = libcamera_format_of(drm, 0);
    ASSERT_TRUE(format);
    EXPECT_EQ(format->codes.fourcc, v4l2);
    EXPECT_FALSE(format->processed);
  }
  const auto packed = libcamera_format_of(v4l2_fourcc('B', 'G', '1', '2'), kCsi2Packed);
  ASSERT_TRUE(packed);
  EXPECT_EQ(packed->codes.fourcc, static_cast<std::uint32_t>(V4L2_PIX_FMT_SBGGR12P));
  EXPECT_FALSE(libcamera_format_of(v4l2_fourcc('R', 'G', '1', '0'), 1));  // packed in a way we do not read
  EXPECT_FALSE(libcamera_format_of(v4l2_fourcc('M', 'J', 'P', 'G'), 0));
}

// RGB888 lies in memory as B, G, R; BGR888 as R, G, B; of four bytes the last is nobody's.
TEST(LibcameraFormat, ColourBecomesTheMosaicThatBeginsWithRed) {
  struct Case {
    std::uint32_t drm;
    std::size_t bytes;
    const char* order;
  };
  for (const Case& c :
       {Case{v4l2_fourcc('R', 'G', '2', '4'), 3, "BGR"}, Case{v4l2_fourcc('B', 'G', '2', '4'), 3, "RGB"},
        Case{v4l2_fourcc('X', 'R', '2', '4'), 4, "BGRX"}, Case{v4l2_fourcc('A', 'B', '2', '4'), 4, "RGBX"}}) {
    const auto format = libcamera_format_of(c.drm, 0);
    ASSERT_TRUE(format);
    EXPECT_TRUE(format->processed);
    constexpr int kWidth = 6, kHeight = 4;
    const std::size_t stride = format->line_bytes(kWidth) + 5;
    std::vector<std::byte> lines(stride * kHeight, std::byte{0xee});
    // Channel in the high bits, pixel in the low.
    for (std::size_t i = 0; i < kWidth * kHeight; ++i)
      for (std::size_t b = 0; b < c.bytes; ++b) {
        const int channel = c.order[b] == 'R' ? 1 : c.order[b] == 'G' ? 2 : c.order[b] == 'B' ? 3 : 7;
        lines[i / kWidth * stride + i % kWidth * c.bytes + b] =
            static_cast<std::byte>(channel << 5 | static_cast<int>(i));
      }
    const FrameFormat frame = format->frame_format(kWidth, kHeight);
    EXPECT_EQ(frame, (FrameFormat{kWidth, kHeight, PixelFormat::bayer_rg8}));
    std::vector<std::byte> out(frame.bytes());
    unpack_libcamera(*format, kWidth, kHeight, stride, lines, out);
    for (int i = 0; i < kWidth * kHeight; ++i) {
      const int x = i % kWidth, y = i / kWidth;
      const int channel = x % 2 + y % 2 + 1;  // R, G, G, B
      EXPECT_EQ(out[static_cast<std::size_t>(i)], static_cast<std::byte>(channel << 5 | i)) << x << ", " << y;
    }
  }
}

}  // namespace
}  // namespace lightwell
