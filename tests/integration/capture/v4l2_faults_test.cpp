// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The V4L2 source against drivers that fail, vanish, fall silent: every state and its words.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <memory>
#include <thread>
#include <vector>

#include "tests/integration/capture/v4l2_source_test.h"

namespace lightwell::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using V4l2Faults = V4l2SourceTest;

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
