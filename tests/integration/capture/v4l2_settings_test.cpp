// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// What is asked of a V4L2 device, what it grants, and what it changes by itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "tests/integration/capture/v4l2_source_test.h"

namespace lightwell::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using V4l2Settings = V4l2SourceTest;

CaptureOptions wanting(const std::string& pixel_format) {
  CaptureOptions options;
  options.pixel_format = pixel_format;
  return options;
}

TEST_F(V4l2Settings, DeviceWithoutRawCodesIsWrongFormatAndSaysWhatItHas) {
  FakeV4l2Model model;
  model.formats = {V4L2_PIX_FMT_GREY, V4L2_PIX_FMT_Y10};
  begin(model, wanting("Mono12"));
  const std::string words = refusal(SourceState::wrong_format);
  EXPECT_THAT(words, HasSubstr("pixel_format Mono12 is not offered"));
  EXPECT_THAT(words, HasSubstr("GREY (Mono8), Y10 (Mono10)"));
}

TEST_F(V4l2Settings, SettingsAreAppliedAndReadBack) {
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

TEST_F(V4l2Settings, SettingTheDeviceRefusesIsOneLineThatNamesValueAndRange) {
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

TEST_F(V4l2Settings, RateThatCannotBeSetIsRefusedAndOneThatIsClampedIsSaid) {
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

TEST_F(V4l2Settings, SensorThatCountsLinesHasItsExposureInTime) {
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

TEST_F(V4l2Settings, SensorThatCountsLinesHasItsRateByBlanking) {
  FakeV4l2Model model;
  model.has_rate = false;
  model.controls[V4L2_CID_HBLANK] = {
      "Horizontal Blanking", V4L2_CTRL_TYPE_INTEGER, 36, 36, 1, 36, V4L2_CTRL_FLAG_READ_ONLY, {}};
  model.controls[V4L2_CID_VBLANK] = {"Vertical Blanking", V4L2_CTRL_TYPE_INTEGER, 2, 1952, 1, 452, 0, {}};
  model.controls[V4L2_CID_PIXEL_RATE] = {"Pixel Rate", V4L2_CTRL_TYPE_INTEGER64, 10'000, 10'000'000, 1,
                                         10'000'000,   V4L2_CTRL_FLAG_READ_ONLY, {}};
  begin(model);  // 100,000 lines a second, 48 + 452 a frame
  ASSERT_TRUE(deliver());
  ASSERT_TRUE(next());
  EXPECT_DOUBLE_EQ(source_->rate_hz(), 200);
  CaptureOptions options;
  options.rate_hz = 80;
  begin(model, options);
  ASSERT_TRUE(deliver());
  ASSERT_TRUE(next()) << source_->describe();
  EXPECT_DOUBLE_EQ(source_->rate_hz(), 80);
  EXPECT_EQ(device_->control(V4L2_CID_VBLANK), 1250 - 48);
  options.rate_hz = 5000;
  begin(model, options);
  EXPECT_THAT(refusal(SourceState::opening), HasSubstr("rate_hz 5000: the device allows 50…2000 Hz"));
}

TEST_F(V4l2Settings, GainInUnitsOfItsOwnIsSaidAndNotTakenForDecibels) {
  FakeV4l2Model model;
  model.controls[V4L2_CID_ANALOGUE_GAIN] = {"Analogue Gain", V4L2_CTRL_TYPE_INTEGER, 0, 232, 1, 100, 0, {}};
  begin(model);
  ASSERT_TRUE(deliver());
  EXPECT_EQ(next().info().gain_db, 0);
  EXPECT_TRUE(says("analogue_gain = 100 in steps of its own")) << source_->describe();
}

TEST_F(V4l2Settings, TriggerThatNobodyCanSetIsRefusedOrSaid) {
  CaptureOptions options;
  options.trigger = "Line0";
  begin(options);
  EXPECT_THAT(refusal(SourceState::opening), HasSubstr("trigger = \"Line0\": no trigger can be set here"));
  options.trigger = "any";
  begin(options);
  ASSERT_TRUE(deliver());
  EXPECT_TRUE(next());
  EXPECT_TRUE(says("no trigger can be set")) << source_->describe();
}

TEST_F(V4l2Settings, ExposureNobodyKnowsIsSaidAndOneThatIsGivenIsBelieved) {
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

TEST_F(V4l2Settings, ExposureChangedBySomebodyElseIsNoticed) {
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

TEST_F(V4l2Settings, ExposureIsChangedWhileFramesComeAndFramesUnderWayAreLeftOut) {
  begin();
  ASSERT_TRUE(deliver());
  ASSERT_TRUE(next());
  const std::uint64_t skipped = source_->counters().skipped;
  ASSERT_EQ(source_->set_exposure_us(7000), ExposureChange::asked);
  EXPECT_TRUE(eventually([&] {
    device_->deliver();
    const FrameLease lease = source_->wait(50ms);
    return lease && lease.info().exposure_us == 7000;
  }));
  EXPECT_GE(source_->counters().skipped, skipped + 3);
  // Out of range: said, and the frames go on as they were.
  ASSERT_EQ(source_->set_exposure_us(1e12), ExposureChange::asked);
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(deliver());
    const FrameLease lease = source_->wait(50ms);
    if (lease) {
      EXPECT_EQ(lease.info().exposure_us, 7000);
    }
  }
}

TEST_F(V4l2Settings, AutomaticExposureIsFollowed) {
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

}  // namespace
}  // namespace lightwell::test
