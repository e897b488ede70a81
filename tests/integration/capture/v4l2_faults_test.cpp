// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The V4L2 source against drivers that fail, vanish, change, count wrong: every state and its words.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <vector>

#include "daemon/capture/v4l2_source.h"
#include "daemon/clock.h"
#include "tests/support/eventually.h"
#include "tests/support/fake_v4l2.h"

namespace lightwell::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class V4l2Faults : public testing::Test {
 protected:
  void begin(FakeV4l2Model model = {}, const CaptureOptions& options = {}) {
    source_.reset();  // before its device
    device_ = std::make_unique<FakeV4l2>(std::move(model));
    source_ = make_v4l2_source(FakeV4l2::kPath, options, *device_);
    ASSERT_TRUE(source_->start());
  }
  void begin(const CaptureOptions& options) { begin(FakeV4l2Model(), options); }
  // The stream is up: a frame can be delivered.
  bool deliver(std::uint32_t flags = 0, std::uint32_t lost = 0, std::ptrdiff_t bytes = -1) {
    return eventually([&] { return device_->deliver(flags, lost, bytes); });
  }
  FrameLease next() {
    FrameLease lease;
    eventually([&] { return static_cast<bool>(lease = source_->wait(100ms)); });
    return lease;
  }
  bool state_becomes(SourceState state) {
    return eventually([&] { return source_->state() == state; });
  }
  bool says(const std::string& words) {
    return eventually([&] { return source_->describe().find(words) != std::string::npos; });
  }
  // The words with which the source refuses to begin.
  std::string refusal(SourceState state) {
    EXPECT_TRUE(eventually([&] { return source_->describe().starts_with(FakeV4l2::kPath); }));
    EXPECT_EQ(source_->state(), state) << source_->describe();
    return source_->describe();
  }

  std::unique_ptr<FakeV4l2> device_;
  std::unique_ptr<CaptureSource> source_;
};

CaptureOptions wanting(const std::string& pixel_format) {
  CaptureOptions options;
  options.pixel_format = pixel_format;
  return options;
}

// Plain, padded, multi-planar, without DMABUF, packed: what arrives is what was sent.
TEST_F(V4l2Faults, CodesArriveWhateverTheLayoutOfLines) {
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

TEST_F(V4l2Faults, MissingDeviceIsNoDeviceAndIsFoundWhenItComes) {
  device_ = std::make_unique<FakeV4l2>();
  device_->unplug();
  source_ = make_v4l2_source(FakeV4l2::kPath, CaptureOptions{}, *device_);
  ASSERT_TRUE(source_->start());
  EXPECT_THAT(refusal(SourceState::no_device), HasSubstr("is not there"));
  device_->plug();
  ASSERT_TRUE(deliver());
  EXPECT_TRUE(next());
  EXPECT_EQ(source_->counters().reconnects, 0U);
}

TEST_F(V4l2Faults, UnpluggedInMidStreamIsNoDeviceAndTheNodeIsLetGo) {
  begin();
  ASSERT_TRUE(deliver());
  const FrameLease held = next();
  ASSERT_TRUE(held);
  const std::byte content = held.bytes().front();
  device_->unplug();
  EXPECT_TRUE(state_becomes(SourceState::no_device));
  // As long as it is open, the kernel keeps the name and the camera comes back under another.
  EXPECT_TRUE(eventually([&] { return device_->open_files() == 0; }));
  FakeV4l2Model other;
  other.width = 32;
  device_->plug(other);
  ASSERT_TRUE(deliver());
  const FrameLease lease = next();
  ASSERT_TRUE(lease);
  EXPECT_EQ(lease.info().format.width, 32);
  EXPECT_GT(lease.info().sequence, held.info().sequence);
  EXPECT_EQ(source_->counters().reconnects, 1U);
  EXPECT_EQ(held.bytes().front(), content);
  EXPECT_EQ(held.info().format.width, 64);
}

TEST_F(V4l2Faults, UnplugAtAnyMomentLeavesNothingBehind) {
  CaptureOptions options;
  begin(options);
  device_->run();
  for (int i = 0; i < 20; ++i) {
    const FrameLease held = i % 3 == 0 ? next() : FrameLease();
    std::this_thread::sleep_for(std::chrono::milliseconds(i % 7));  // any moment will do
    device_->unplug();
    ASSERT_TRUE(eventually([&] { return device_->open_files() == 0; }));
    device_->plug();
    ASSERT_TRUE(next());
  }
  device_->hush();
  source_->stop();
  EXPECT_EQ(device_->open_files(), 0);
  source_.reset();
  EXPECT_EQ(device_->mappings(), 0);
}

TEST_F(V4l2Faults, BrokenStreamIsStartedAnew) {
  begin();
  ASSERT_TRUE(deliver());
  ASSERT_TRUE(next());
  device_->break_off();
  ASSERT_TRUE(deliver());
  EXPECT_TRUE(next());
  EXPECT_EQ(source_->counters().reconnects, 1U);
}

TEST_F(V4l2Faults, FailingDequeueIsStalledWithTheKernelsWords) {
  begin();
  ASSERT_TRUE(deliver());
  ASSERT_TRUE(next());
  device_->fail(VIDIOC_DQBUF, EIO);
  EXPECT_TRUE(deliver());
  EXPECT_TRUE(says("Input/output error (EIO)")) << source_->describe();
  EXPECT_EQ(source_->state(), SourceState::stalled);
  device_->fail(VIDIOC_DQBUF, EIO, 0);
  EXPECT_TRUE(eventually([&] {
    device_->deliver();
    return static_cast<bool>(source_->wait(20ms));
  }));
  EXPECT_TRUE(state_becomes(SourceState::streaming));
}

TEST_F(V4l2Faults, FailingStreamOnSaysSoAndIsTriedAgain) {
  device_ = std::make_unique<FakeV4l2>();
  device_->fail(VIDIOC_STREAMON, EIO, 2);
  source_ = make_v4l2_source(FakeV4l2::kPath, CaptureOptions{}, *device_);
  ASSERT_TRUE(source_->start());
  EXPECT_THAT(refusal(SourceState::opening), HasSubstr("does not start to stream"));
  ASSERT_TRUE(deliver());
  EXPECT_TRUE(next());
}

TEST_F(V4l2Faults, EveryCallThatFailsOnTheWayIsSurvived) {
  for (const unsigned long request :
       {VIDIOC_QUERYCAP, VIDIOC_G_FMT, VIDIOC_REQBUFS, VIDIOC_QUERYBUF, VIDIOC_EXPBUF, VIDIOC_QBUF,
        VIDIOC_STREAMON, VIDIOC_DQBUF, VIDIOC_G_INPUT, VIDIOC_G_EXT_CTRLS, VIDIOC_QUERY_EXT_CTRL,
        VIDIOC_G_PARM}) {
    for (const int error : {EIO, ENODEV}) {
      device_ = std::make_unique<FakeV4l2>();
      device_->fail(request, error, 1);
      source_ = make_v4l2_source(FakeV4l2::kPath, CaptureOptions{}, *device_);
      device_->run();
      ASSERT_TRUE(source_->start());
      EXPECT_TRUE(next()) << request << " " << error << " " << source_->describe();
      device_->hush();
      source_.reset();
      EXPECT_EQ(device_->open_files(), 0);
      EXPECT_EQ(device_->mappings(), 0);
    }
  }
}

TEST_F(V4l2Faults, InputWithoutSignalIsNoSignalAndItsPicturesAreNotFrames) {
  begin();
  ASSERT_TRUE(deliver());
  ASSERT_TRUE(next());
  device_->set_input_status(V4L2_IN_ST_NO_SIGNAL);
  device_->run();  // noise goes on
  EXPECT_TRUE(eventually([&] {
    static_cast<void>(source_->wait(0ms));
    return source_->state() == SourceState::no_signal;
  }));
  EXPECT_THAT(source_->describe(), HasSubstr("HDMI 0 has no signal"));
  const std::uint64_t received = source_->counters().received;
  const std::uint64_t incomplete = source_->counters().incomplete;
  static_cast<void>(source_->wait(0ms));
  ASSERT_TRUE(eventually([&] { return source_->counters().incomplete > incomplete + 5; }));
  EXPECT_FALSE(source_->wait(20ms));
  EXPECT_EQ(source_->counters().received, received);
  device_->set_input_status(0);
  EXPECT_TRUE(next());
  EXPECT_TRUE(state_becomes(SourceState::streaming));
  EXPECT_EQ(source_->counters().reconnects, 0U);
  device_->hush();
}

TEST_F(V4l2Faults, NoSignalFromTheStartHasItsOwnWords) {
  for (const auto& [status, words] :
       {std::pair(V4L2_IN_ST_NO_POWER, "has no power"), std::pair(V4L2_IN_ST_NO_SIGNAL, "has no signal"),
        std::pair(V4L2_IN_ST_NO_SYNC, "finds no lock")}) {
    device_ = std::make_unique<FakeV4l2>();
    device_->set_input_status(static_cast<std::uint32_t>(status));
    source_ = make_v4l2_source(FakeV4l2::kPath, CaptureOptions{}, *device_);
    ASSERT_TRUE(source_->start());
    EXPECT_THAT(refusal(SourceState::no_signal), HasSubstr(words));
    source_.reset();
  }
}

TEST_F(V4l2Faults, SilentDeviceIsStalledUntilItSendsAgain) {
  begin();
  device_->run();
  ASSERT_TRUE(next());
  device_->hush();
  EXPECT_TRUE(state_becomes(SourceState::stalled));
  EXPECT_TRUE(says("sends no frames")) << source_->describe();
  device_->run();
  EXPECT_TRUE(eventually([&] { return source_->wait(20ms) && source_->state() == SourceState::streaming; }));
  device_->hush();
}

TEST_F(V4l2Faults, CorruptedEmptyAndShortBuffersAreIncompleteAndNobodySeesThem) {
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

TEST_F(V4l2Faults, GapsOfTheSequenceAreLostFramesAcross32BitsToo) {
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

TEST_F(V4l2Faults, DriverThatCountsAnewOrNotAtAllLosesNothing) {
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

TEST_F(V4l2Faults, StampAtTheStartOfTheExposureBecomesItsMiddle) {
  begin();  // exposure 2 ms, stamped 4 ms before the frame is ready
  ASSERT_TRUE(deliver());
  const FrameLease lease = next();
  ASSERT_TRUE(lease);
  EXPECT_DOUBLE_EQ(lease.info().exposure_us, 2000);
  // Ready is not after received; V4L2 stamps in whole µs.
  EXPECT_LE(lease.info().capture_mono_ns, lease.info().received_mono_ns - 3'000'000);
  EXPECT_TRUE(says("stamped at the start of the exposure")) << source_->describe();
}

TEST_F(V4l2Faults, StampsOfEveryKindGiveTheMiddleOfTheSameExposure) {
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

TEST_F(V4l2Faults, StampOfAnotherClockIsNotBelievedAndThatIsSaid) {
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

TEST_F(V4l2Faults, StampOfTheFutureIsNoLaterThanReception) {
  FakeV4l2Model model;
  model.stamp_age_ns = -1'000'000'000;
  begin(model);
  ASSERT_TRUE(deliver());
  const FrameLease lease = next();
  ASSERT_TRUE(lease);
  EXPECT_EQ(lease.info().capture_mono_ns, lease.info().received_mono_ns);
}

TEST_F(V4l2Faults, DeviceWithoutRawCodesIsWrongFormatAndSaysWhatItHas) {
  FakeV4l2Model model;
  model.formats = {V4L2_PIX_FMT_GREY, V4L2_PIX_FMT_Y10};
  begin(model, wanting("Mono12"));
  const std::string words = refusal(SourceState::wrong_format);
  EXPECT_THAT(words, HasSubstr("pixel_format Mono12 is not offered"));
  EXPECT_THAT(words, HasSubstr("GREY (Mono8), Y10 (Mono10)"));
}

TEST_F(V4l2Faults, SettingsAreAppliedAndReadBack) {
  FakeV4l2Model model;
  model.formats = {V4L2_PIX_FMT_GREY, V4L2_PIX_FMT_Y16, V4L2_PIX_FMT_Y10P};
  model.controls[V4L2_CID_EXPOSURE_AUTO] = {"Auto Exposure",
                                            V4L2_CTRL_TYPE_MENU,
                                            0,
                                            3,
                                            1,
                                            3,
                                            0,
                                            {"Auto Mode", "Manual Mode", "", "Aperture Priority Mode"}};
  model.controls[V4L2_CID_EXPOSURE_AUTO_PRIORITY] = {
      "Exposure, Dynamic Framerate", V4L2_CTRL_TYPE_BOOLEAN, 0, 1, 1, 1, 0, {}};
  model.controls[V4L2_CID_GAIN] = {"Gain", V4L2_CTRL_TYPE_INTEGER, 0, 255, 1, 16, 0, {}};
  model.controls[0x009f0001] = {"HDR Companding", V4L2_CTRL_TYPE_BOOLEAN, 0, 1, 1, 0, 0, {}};
  CaptureOptions options = wanting("Mono10");
  options.width = 128;
  options.height = 100;
  options.rate_hz = 40;
  options.exposure_us = 5000;
  options.controls = "gain=20, hdr_companding=1";
  begin(model, options);
  ASSERT_TRUE(deliver());
  const FrameLease lease = next();
  ASSERT_TRUE(lease) << source_->describe();
  EXPECT_EQ(lease.info().format, (FrameFormat{128, 100, PixelFormat::mono10}));
  EXPECT_DOUBLE_EQ(lease.info().exposure_us, 5000);
  EXPECT_DOUBLE_EQ(source_->rate_hz(), 40);
  EXPECT_EQ(device_->control(V4L2_CID_EXPOSURE_AUTO), V4L2_EXPOSURE_MANUAL);
  EXPECT_EQ(device_->control(V4L2_CID_EXPOSURE_AUTO_PRIORITY), 0);
  EXPECT_EQ(device_->control(V4L2_CID_GAIN), 20);
  EXPECT_TRUE(says("hdr_companding = 1")) << source_->describe();
}

TEST_F(V4l2Faults, SettingTheDeviceRefusesIsOneLineThatNamesValueAndRange) {
  struct Case {
    CaptureOptions options;
    const char* words;
  };
  std::vector<Case> cases(6);
  cases[0].options.exposure_us = 200'000;
  cases[0].words = "exposure 200000 µs: the device allows 100…100000 µs";
  cases[1].options.exposure_us = 20;
  cases[1].words = "exposure 20 µs: the device allows 100…100000 µs";
  cases[2].options.width = 5000;
  cases[2].words = "5000×48 was asked for, the device grants 640×48";
  cases[3].options.controls = "exposure_time_absolute=0";
  cases[3].words = "control exposure_time_absolute = 0: the device allows 1…1000";
  cases[4].options.controls = "gein=3";
  cases[4].words = "control \"gein=3\": name=value is expected, with one of exposure_time_absolute";
  cases[5].options.controls = "exposure_time_absolute=fast";
  cases[5].words = "control exposure_time_absolute = fast: the device allows 1…1000";
  for (const Case& c : cases) {
    begin(c.options);
    EXPECT_THAT(refusal(SourceState::opening), HasSubstr(c.words));
    EXPECT_EQ(source_->describe().find('\n'), std::string::npos);
    source_.reset();
  }
}

TEST_F(V4l2Faults, RateThatCannotBeSetIsRefusedAndOneThatIsClampedIsSaid) {
  CaptureOptions options;
  options.rate_hz = 1000;
  begin(options);
  ASSERT_TRUE(deliver());
  EXPECT_TRUE(says("asked for 1000 Hz, the device grants 200")) << source_->describe();
  FakeV4l2Model model;
  model.has_rate = false;
  source_.reset();
  begin(model, options);
  EXPECT_THAT(refusal(SourceState::opening), HasSubstr("has no frame rate to set"));
}

TEST_F(V4l2Faults, SensorThatCountsLinesHasItsExposureInTime) {
  FakeV4l2Model model;
  model.controls.clear();
  model.controls[V4L2_CID_EXPOSURE] = {"Exposure", V4L2_CTRL_TYPE_INTEGER, 1, 4000, 1, 100, 0, {}};
  model.controls[V4L2_CID_HBLANK] = {
      "Horizontal Blanking", V4L2_CTRL_TYPE_INTEGER, 36, 36, 1, 36, V4L2_CTRL_FLAG_READ_ONLY, {}};
  model.controls[V4L2_CID_PIXEL_RATE] = {"Pixel Rate", V4L2_CTRL_TYPE_INTEGER64, 10'000'000, 10'000'000, 1,
                                         10'000'000,   V4L2_CTRL_FLAG_READ_ONLY, {}};
  CaptureOptions options;
  options.exposure_us = 3000;  // a line of 64 + 36 pixels at 10 MHz takes 10 µs
  begin(model, options);
  ASSERT_TRUE(deliver());
  const FrameLease lease = next();
  ASSERT_TRUE(lease) << source_->describe();
  EXPECT_DOUBLE_EQ(lease.info().exposure_us, 3000);
  EXPECT_EQ(device_->control(V4L2_CID_EXPOSURE), 300);
}

TEST_F(V4l2Faults, ExposureNobodyKnowsIsSaidAndOneThatIsGivenIsBelieved) {
  FakeV4l2Model model;
  model.controls.clear();
  begin(model);
  ASSERT_TRUE(deliver());
  EXPECT_TRUE(says("does not say how long it exposes; give exposure_us")) << source_->describe();
  EXPECT_EQ(next().info().exposure_us, 0);
  source_.reset();
  CaptureOptions options;
  options.exposure_us = 1500;
  begin(model, options);
  ASSERT_TRUE(deliver());
  EXPECT_EQ(next().info().exposure_us, 1500);
  EXPECT_TRUE(says("exposure is taken as given")) << source_->describe();
}

TEST_F(V4l2Faults, ExposureChangedBySomebodyElseIsNoticed) {
  begin();
  ASSERT_TRUE(deliver());
  ASSERT_TRUE(next());
  device_->change_control(V4L2_CID_EXPOSURE_ABSOLUTE, 70);
  EXPECT_TRUE(eventually([&] {
    device_->deliver();
    const FrameLease lease = source_->wait(50ms);
    return lease && lease.info().exposure_us == 7000;
  }));
}

TEST_F(V4l2Faults, AutomaticExposureIsFollowed) {
  FakeV4l2Model model;
  model.controls[V4L2_CID_EXPOSURE_AUTO] = {
      "Auto Exposure", V4L2_CTRL_TYPE_MENU, 0, 1, 1, 0, 0, {"Auto Mode", "Manual Mode"}};
  begin(model);
  device_->run();
  ASSERT_TRUE(next());
  EXPECT_TRUE(says("exposes automatically")) << source_->describe();
  // No event tells of what a device changes by itself: the value is asked for.
  device_->change_control(V4L2_CID_EXPOSURE_ABSOLUTE, 55);
  EXPECT_TRUE(eventually([&] {
    const FrameLease lease = source_->wait(50ms);
    return lease && lease.info().exposure_us == 5500;
  }));
  device_->hush();
}

TEST_F(V4l2Faults, PictureThatChangesItsSizeIsOpenedAnew) {
  begin();
  ASSERT_TRUE(deliver());
  ASSERT_TRUE(next());
  device_->change_source();
  ASSERT_TRUE(eventually([&] { return source_->counters().reconnects == 1 || device_->deliver(); }));
  EXPECT_TRUE(eventually([&] {
    device_->deliver();
    return source_->wait(20ms) && source_->counters().reconnects == 1;
  }));
}

TEST_F(V4l2Faults, DeviceInUseSaysSoAndIsTakenWhenItIsFree) {
  begin();
  ASSERT_TRUE(deliver());
  ASSERT_TRUE(next());
  const auto second = make_v4l2_source(FakeV4l2::kPath, {}, *device_);
  ASSERT_TRUE(second->start());
  ASSERT_TRUE(eventually([&] {
    return second->describe().find("another program is using it") != std::string::npos;
  })) << second->describe();
  EXPECT_EQ(second->state(), SourceState::opening);
  source_->stop();
  EXPECT_TRUE(eventually([&] {
    device_->deliver();
    return static_cast<bool>(second->wait(20ms));
  }));
}

TEST_F(V4l2Faults, DeviceOpensAnewWhileALeaseOfBeforeIsHeld) {
  for (const bool exports : {true, false}) {
    FakeV4l2Model model;
    model.exports = exports;
    begin(model);
    ASSERT_TRUE(deliver());
    const FrameLease held = next();
    ASSERT_TRUE(held);
    const std::byte content = held.bytes().front();
    source_->stop();
    ASSERT_TRUE(source_->start());
    for (int i = 0; i < 20; ++i) {
      ASSERT_TRUE(deliver());
      ASSERT_TRUE(next());
    }
    EXPECT_EQ(held.bytes().front(), content);
    EXPECT_EQ(held.bytes().back(), content);
  }
}

TEST_F(V4l2Faults, PathThatIsNoneIsUsage) {
  const auto source = make_v4l2_source("video0", {});
  const Status started = source->start();
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error().kind, ErrorKind::usage);
  EXPECT_THAT(started.error().message, HasSubstr("v4l2:/dev/video0"));
}

TEST_F(V4l2Faults, FileThatIsNoDeviceSaysSo) {
  const auto source = make_v4l2_source("/dev/null", {});
  ASSERT_TRUE(source->start());
  EXPECT_TRUE(eventually([&] {
    return source->describe().find("is not a V4L2 device") != std::string::npos;
  })) << source->describe();
  EXPECT_EQ(source->state(), SourceState::opening);
}

}  // namespace
}  // namespace lightwell::test
