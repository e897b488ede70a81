// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The V4L2 source on vivid, which fails on demand, and on v4l2loopback, whose content is known.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>

#include "daemon/capture/capture_source.h"
#include "daemon/capture/v4l2_device.h"
#include "daemon/capture/v4l2_format.h"
#include "daemon/clock.h"
#include "tests/hardware/loopback_writer.h"
#include "tests/support/eventually.h"

namespace lightwell::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr const char* kVivid = "/dev/video10";
constexpr const char* kLoopback = "/dev/video22";

class V4l2Drivers : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kVivid) || !std::filesystem::exists(kLoopback))
      GTEST_SKIP() << "there is no " << kVivid << ": run in the virtual machine";
  }
  static CaptureOptions small() {
    CaptureOptions options;
    options.width = 320;
    options.height = 180;
    options.pixel_format = "Mono16";
    options.rate_hz = 30;
    options.exposure_us = 1000;
    return options;
  }
  void begin(const std::string& path, const CaptureOptions& options) {
    source_.reset();
    auto made = make_capture_source("v4l2:" + path, options);
    ASSERT_TRUE(made.ok()) << made.error().message;
    source_ = std::move(made).value();
    ASSERT_TRUE(source_->start());
  }
  FrameLease next() {
    FrameLease lease;
    eventually([&] { return static_cast<bool>(lease = source_->wait(200ms)); });
    return lease;
  }
  bool state_becomes(SourceState state) {
    return eventually([&] {
      static_cast<void>(source_->wait(0ms));
      return source_->state() == state;
    });
  }
  // A knob of the driver, turned from outside as v4l2-ctl would.
  static void turn(const std::string& assignment, int input = -1) {
    V4l2Device device(system_v4l2_calls());
    ASSERT_EQ(device.open(kVivid), 0);
    if (input >= 0) {
      ASSERT_EQ(device.ioctl(VIDIOC_S_INPUT, &input), 0);
    }
    if (assignment.empty()) return;
    const Status status = device.set(assignment);
    ASSERT_TRUE(status.ok()) << status.error().message;
  }
  static void driver(const char* what) {
    std::ofstream(std::string("/sys/bus/platform/drivers/vivid/") + what) << "vivid.0" << std::flush;
  }
  static bool replug() {
    driver("unbind");
    driver("bind");
    return eventually([] { return std::filesystem::exists(kVivid); });
  }
  // From now to the next frame; said, not judged: the machine is emulated.
  void say_recovery(const char* after, std::chrono::steady_clock::time_point since) {
    ASSERT_TRUE(next()) << source_->describe();
    const auto ms =
        std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - since)
            .count();
    std::printf("frames %ld ms after %s\n", static_cast<long>(ms), after);
  }

  std::unique_ptr<CaptureSource> source_;
};

TEST_F(V4l2Drivers, EveryFormatOfTheDriverThatWeReadStreams) {
  std::vector<std::uint32_t> formats;
  {
    V4l2Device device(system_v4l2_calls());
    ASSERT_EQ(device.open(kVivid), 0);
    formats = device.formats();
  }
  std::string seen;
  for (const std::uint32_t fourcc : formats) {
    const auto known = v4l2_format_of(fourcc);
    if (!known) continue;
    {
      V4l2Device device(system_v4l2_calls());
      ASSERT_EQ(device.open(kVivid), 0);
      V4l2FrameLayout layout{320, 180, fourcc, 0, 0, 0};
      ASSERT_EQ(device.set_layout(layout), 0);
      ASSERT_EQ(layout.fourcc, fourcc);
    }
    CaptureOptions as_it_is;
    as_it_is.exposure_us = 1000;
    as_it_is.rate_hz = 30;
    begin(kVivid, as_it_is);
    const FrameLease lease = next();
    ASSERT_TRUE(lease) << fourcc_name(fourcc) << " " << source_->describe();
    EXPECT_EQ(lease.info().format, known->frame_format(320, 180)) << fourcc_name(fourcc);
    EXPECT_EQ(lease.bytes().size(), lease.info().format.bytes());
    seen += " " + fourcc_name(fourcc);
    source_->stop();
  }
  std::printf("streamed:%s\n", seen.c_str());
  EXPECT_THAT(seen, HasSubstr(" GREY"));
  EXPECT_THAT(seen, HasSubstr(" Y16"));
  EXPECT_THAT(seen, HasSubstr(" RG12"));
}

TEST_F(V4l2Drivers, BigEndianAndLittleEndianAreTheSamePicture) {
  std::vector<std::byte> pictures[2];
  for (const std::uint32_t fourcc : {V4L2_PIX_FMT_Y16, V4L2_PIX_FMT_Y16_BE}) {
    {
      V4l2Device device(system_v4l2_calls());
      ASSERT_EQ(device.open(kVivid), 0);
      V4l2FrameLayout layout{320, 180, fourcc, 0, 0, 0};
      ASSERT_EQ(device.set_layout(layout), 0);
    }
    CaptureOptions options;
    options.exposure_us = 1000;
    options.controls = "osd_text_mode=2, test_pattern=0";  // no text: colour bars alone
    begin(kVivid, options);
    const FrameLease lease = next();
    ASSERT_TRUE(lease) << source_->describe();
    pictures[fourcc == V4L2_PIX_FMT_Y16].assign(lease.bytes().begin(), lease.bytes().end());
    source_->stop();
  }
  EXPECT_EQ(pictures[0], pictures[1]);
  const auto& p = pictures[0];  // bars: not one value all over
  EXPECT_TRUE(std::any_of(p.begin(), p.end(), [&](std::byte b) { return b != p.front(); }));
}

TEST_F(V4l2Drivers, TimesAreTheDriversOwn) {
  begin(kVivid, small());
  const FrameLease lease = next();
  ASSERT_TRUE(lease);
  EXPECT_TRUE(eventually([&] { return source_->describe().find("stamped at the") != std::string::npos; }))
      << source_->describe();
  std::printf("%s\n", source_->describe().c_str());
}

TEST_F(V4l2Drivers, StreamThatDoesNotBeginIsTriedAgain) {
  turn("inject_vidioc_streamon_error=1");  // once
  begin(kVivid, small());
  EXPECT_TRUE(eventually([&] {
    return source_->describe().find("does not start to stream") != std::string::npos || source_->wait(0ms);
  }));
  EXPECT_TRUE(next()) << source_->describe();
}

TEST_F(V4l2Drivers, FatalStreamingErrorIsOvercome) {
  begin(kVivid, small());
  ASSERT_TRUE(next());
  const auto now = std::chrono::steady_clock::now();
  turn("inject_fatal_streaming_error=1");
  EXPECT_TRUE(eventually([&] {
    static_cast<void>(source_->wait(100ms));
    return source_->counters().reconnects == 1;
  })) << source_->describe();
  say_recovery("a fatal streaming error", now);
}

TEST_F(V4l2Drivers, DroppedBuffersAreCountedAsLost) {
  begin(kVivid, small());
  ASSERT_TRUE(next());
  turn("percentage_of_dropped_buffers=50");
  EXPECT_TRUE(eventually([&] {
    static_cast<void>(source_->wait(100ms));
    return source_->counters().lost > 5;
  }));
  turn("percentage_of_dropped_buffers=0");
  EXPECT_EQ(source_->counters().reconnects, 0U);
}

TEST_F(V4l2Drivers, DisconnectedDeviceIsNoDeviceAndComesBack) {
  begin(kVivid, small());
  const FrameLease held = next();
  ASSERT_TRUE(held);
  const std::vector<std::byte> bytes(held.bytes().begin(), held.bytes().end());
  turn("disconnect=1");
  EXPECT_TRUE(state_becomes(SourceState::no_device)) << source_->describe();
  ASSERT_TRUE(replug());
  say_recovery("the device was back", std::chrono::steady_clock::now());
  EXPECT_EQ(source_->counters().reconnects, 1U);
  EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), held.bytes().begin(), held.bytes().end()));
}

TEST_F(V4l2Drivers, DriverTakenAwayAtAnyMomentComesBack) {
  begin(kVivid, small());
  for (int i = 0; i < 5; ++i) {
    const FrameLease held = i % 2 == 0 ? next() : FrameLease();
    std::this_thread::sleep_for(std::chrono::milliseconds(17 * i));  // any moment will do
    driver("unbind");
    EXPECT_TRUE(state_becomes(SourceState::no_device)) << source_->describe();
    driver("bind");
    ASSERT_TRUE(eventually([] { return std::filesystem::exists(kVivid); }));
    say_recovery("the driver was back", std::chrono::steady_clock::now());
  }
}

TEST_F(V4l2Drivers, InputWithoutSignalIsNoSignal) {
  // Input 1 is a television tuner; signal modes are choices of vivid's own.
  turn("standard_signal_mode=No Signal", 1);
  CaptureOptions options;
  options.pixel_format = "Mono8";
  options.exposure_us = 1000;
  begin(kVivid, options);
  EXPECT_TRUE(state_becomes(SourceState::no_signal)) << source_->describe();
  EXPECT_THAT(source_->describe(), HasSubstr("has no signal"));
  turn("standard_signal_mode=Current Standard");
  EXPECT_TRUE(next()) << source_->describe();
  EXPECT_TRUE(state_becomes(SourceState::streaming));
  turn("standard_signal_mode=No Signal");
  EXPECT_TRUE(state_becomes(SourceState::no_signal)) << source_->describe();
  turn("standard_signal_mode=Current Standard");
  EXPECT_TRUE(state_becomes(SourceState::streaming)) << source_->describe();
  source_->stop();
  turn("", 0);
}

TEST_F(V4l2Drivers, DigitalSignalIsFollowedInSizeAndMissedWhenItGoes) {
  // Input 3 is HDMI. Frames of 640×480 are what an emulated processor makes in good time.
  turn("dv_timings_signal_mode=Selected DV Timings, dv_timings=640x480p59", 3);
  CaptureOptions options;
  options.pixel_format = "Mono8";
  options.exposure_us = 1000;
  begin(kVivid, options);
  const auto width_becomes = [&](int width) {
    return eventually([&] {
      const FrameLease lease = source_->wait(100ms);
      return lease && lease.info().format.width == width;
    });
  };
  EXPECT_TRUE(width_becomes(640)) << source_->describe();
  turn("dv_timings=720x480p59");
  EXPECT_TRUE(width_becomes(720)) << source_->describe();
  turn("dv_timings_signal_mode=No Signal");
  EXPECT_TRUE(state_becomes(SourceState::no_signal)) << source_->describe();
  EXPECT_THAT(source_->describe(), HasSubstr("has no signal"));
  turn("dv_timings_signal_mode=Out of Range");
  EXPECT_TRUE(eventually([&] {
    static_cast<void>(source_->wait(0ms));
    return source_->describe().find("a signal that the device cannot take") != std::string::npos;
  })) << source_->describe();
  turn("dv_timings_signal_mode=Selected DV Timings");
  EXPECT_TRUE(width_becomes(720)) << source_->describe();
  source_->stop();
  turn("dv_timings_signal_mode=Current DV Timings", 3);
  turn("", 0);
}

TEST_F(V4l2Drivers, ContentArrivesExactly) {
  constexpr int kWidth = 66, kHeight = 50;
  LoopbackWriter writer(kLoopback, V4L2_PIX_FMT_Y16, kWidth, kHeight);
  const auto byte_at = [](std::uint64_t n, std::size_t i) {
    return static_cast<std::byte>((n * 131 + i * 7 + i / 251) & 255);
  };
  writer.run(50, [&](std::uint64_t n, std::span<std::byte> frame) {
    for (std::size_t i = 0; i < frame.size(); ++i) frame[i] = byte_at(n, i);
  });
  CaptureOptions options;
  options.exposure_us = 1000;
  begin(kLoopback, options);
  for (int k = 0; k < 20; ++k) {
    const FrameLease lease = next();
    ASSERT_TRUE(lease) << source_->describe();
    ASSERT_EQ(lease.info().format, (FrameFormat{kWidth, kHeight, PixelFormat::mono16}));
    // n modulo 256 from the first byte: 131 · 43 = 1 modulo 256.
    const std::uint64_t n = static_cast<std::uint64_t>(lease.bytes()[0]) * 43;
    for (std::size_t i = 0; i < lease.bytes().size(); ++i) ASSERT_EQ(lease.bytes()[i], byte_at(n, i)) << i;
  }
  writer.rest();
  EXPECT_TRUE(state_becomes(SourceState::stalled)) << source_->describe();
}

}  // namespace
}  // namespace lightwell::test
