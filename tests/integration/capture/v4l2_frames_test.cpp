// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// What V4L2 hands over, as frames: layout of lines, damage, numbers, times.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "daemon/clock.h"
#include "tests/integration/capture/v4l2_source_test.h"

namespace lightwell::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using V4l2Frames = V4l2SourceTest;

// Plain, padded, multi-planar, without DMABUF, packed: what arrives is what was sent.
TEST_F(V4l2Frames, CodesArriveWhateverTheLayoutOfLines) {
  struct Case {
    std::uint32_t fourcc;
    std::size_t padding;
    bool multi_planar, exports;
    FrameFormat format;
  };
  const std::vector<Case> cases = {
      {V4L2_PIX_FMT_GREY, 0, false, true, {64, 48, PixelFormat::mono8}},
      {V4L2_PIX_FMT_GREY, 16, false, true, {64, 48, PixelFormat::mono8}},
      {V4L2_PIX_FMT_GREY, 0, false, false, {64, 48, PixelFormat::mono8}},
      {V4L2_PIX_FMT_Y16, 0, true, true, {64, 48, PixelFormat::mono16}},
      {V4L2_PIX_FMT_Y12, 32, true, false, {64, 48, PixelFormat::mono12}},
      {V4L2_PIX_FMT_SBGGR10P, 4, false, true, {62, 46, PixelFormat::bayer_rg10}},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.padding);
    FakeV4l2Model model;
    model.formats = {c.fourcc};
    model.padding = c.padding;
    model.multi_planar = c.multi_planar;
    model.exports = c.exports;
    begin(model);
    for (int n = 0; n < 12; ++n) {
      ASSERT_TRUE(deliver());
      const FrameLease lease = next();
      ASSERT_TRUE(lease);
      ASSERT_EQ(lease.info().format, c.format);
      ASSERT_EQ(lease.bytes().size(), c.format.bytes());
      // Every byte of frame n is n, and 10 packed bits of such bytes are n·4 + two bits of n.
      const auto code = c.fourcc == V4L2_PIX_FMT_SBGGR10P
                            ? static_cast<unsigned>(n) << 2 | (static_cast<unsigned>(n) & 3)
                            : static_cast<unsigned>(n);
      if (storage_bits(c.format.pixel_format) == 8) {
        EXPECT_EQ(lease.bytes().front(), std::byte(n));
        EXPECT_EQ(lease.bytes().back(), std::byte(n));
      } else if (c.fourcc == V4L2_PIX_FMT_SBGGR10P) {
        // Pixel 1 of a group, the first that is red, has bits 2 and 3 of the fifth byte.
        EXPECT_EQ(static_cast<unsigned>(lease.bytes()[0]),
                  (code & ~3U & 255U) | (static_cast<unsigned>(n) >> 2 & 3U));
      }
      EXPECT_TRUE(std::none_of(lease.bytes().begin(), lease.bytes().end(),
                               [](std::byte b) { return b == std::byte{0xee}; }));
    }
  }
}

TEST_F(V4l2Frames, CorruptedEmptyAndShortBuffersAreIncompleteAndNobodySeesThem) {
  begin();
  ASSERT_TRUE(deliver());
  ASSERT_TRUE(next());
  ASSERT_TRUE(deliver(V4L2_BUF_FLAG_ERROR));
  ASSERT_TRUE(deliver(0, 0, 0));
  ASSERT_TRUE(deliver(0, 0, 64 * 48 - 1));
  ASSERT_TRUE(eventually([&] { return source_->counters().incomplete == 3; }));
  ASSERT_TRUE(deliver());
  const FrameLease lease = next();
  ASSERT_TRUE(lease);
  EXPECT_EQ(lease.bytes().front(), std::byte{4});
  EXPECT_EQ(lease.info().sequence, 4U);
  EXPECT_EQ(source_->counters().lost, 0U);
}

TEST_F(V4l2Frames, GapsOfTheSequenceAreLostFramesAcross32BitsToo) {
  device_ = std::make_unique<FakeV4l2>();
  device_->count_from(0xfffffffeU);
  source_ = make_v4l2_source(FakeV4l2::kPath, CaptureOptions{}, *device_);
  ASSERT_TRUE(source_->start());
  ASSERT_TRUE(deliver());
  ASSERT_TRUE(next());
  ASSERT_TRUE(deliver(0, 3));
  const FrameLease lease = next();
  ASSERT_TRUE(lease);
  EXPECT_EQ(source_->counters().lost, 3U);
  EXPECT_EQ(lease.info().sequence, 4U);
}

TEST_F(V4l2Frames, DriverThatCountsAnewOrNotAtAllLosesNothing) {
  begin();
  for (int i = 0; i < 5; ++i) {
    device_->count_from(i < 3 ? 7 : 0);
    ASSERT_TRUE(deliver());
    const FrameLease lease = next();
    ASSERT_TRUE(lease);
    EXPECT_EQ(lease.info().sequence, static_cast<std::uint64_t>(i));
  }
  EXPECT_EQ(source_->counters().lost, 0U);
}

TEST_F(V4l2Frames, StampAtTheStartOfTheExposureBecomesItsMiddle) {
  begin();  // exposure 2 ms, stamped 4 ms before the frame is ready
  ASSERT_TRUE(deliver());
  const FrameLease lease = next();
  ASSERT_TRUE(lease);
  EXPECT_DOUBLE_EQ(lease.info().exposure_us, 2000);
  // Ready is not after received; V4L2 stamps in whole µs.
  EXPECT_LE(lease.info().capture_mono_ns, lease.info().received_mono_ns - 3'000'000);
  EXPECT_TRUE(says("stamped at the start of the exposure")) << source_->describe();
}

TEST_F(V4l2Frames, StampsOfEveryKindGiveTheMiddleOfTheSameExposure) {
  // Read-out counts as nothing: a frame stamped at its start, its end, or not at all is the same 2 ms.
  struct Case {
    std::uint32_t flags;
    std::int64_t age_ns;
    const char* words;
  };
  for (const Case& c :
       {Case{V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE, 500'002'000'000, "start"},
        Case{V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_EOF, 500'000'000'000, "end"}}) {
    FakeV4l2Model model;
    model.stamp_flags = c.flags;
    model.stamp_age_ns = c.age_ns;
    begin(model);
    const std::int64_t before = mono_now_ns();
    ASSERT_TRUE(deliver());
    const std::int64_t after = mono_now_ns();
    const FrameLease lease = next();
    ASSERT_TRUE(lease);
    const std::int64_t middle = lease.info().capture_mono_ns + 500'001'000'000;
    EXPECT_GE(middle, before - 1000);
    EXPECT_LE(middle, after);
    EXPECT_TRUE(says(c.words)) << source_->describe();
  }
}

TEST_F(V4l2Frames, StampOfAnotherClockIsNotBelievedAndThatIsSaid) {
  FakeV4l2Model model;
  model.stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN;
  model.stamp_age_ns = 3'600'000'000'000;
  begin(model);
  ASSERT_TRUE(deliver());
  const FrameLease lease = next();
  ASSERT_TRUE(lease);
  EXPECT_EQ(lease.info().capture_mono_ns, lease.info().received_mono_ns - 1'000'000);
  EXPECT_TRUE(says("times are of reception")) << source_->describe();
}

TEST_F(V4l2Frames, StampOfTheFutureIsNoLaterThanReception) {
  FakeV4l2Model model;
  model.stamp_age_ns = -1'000'000'000;
  begin(model);
  ASSERT_TRUE(deliver());
  const FrameLease lease = next();
  ASSERT_TRUE(lease);
  EXPECT_EQ(lease.info().capture_mono_ns, lease.info().received_mono_ns);
}

}  // namespace
}  // namespace lightwell::test
