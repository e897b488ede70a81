// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The signal on a V4L2 input: missing, come back, changed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <memory>

#include "tests/integration/capture/v4l2_source_test.h"

namespace lightwell::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using V4l2Signal = V4l2SourceTest;

TEST_F(V4l2Signal, InputWithoutSignalIsNoSignalAndItsPicturesAreNotFrames) {
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

TEST_F(V4l2Signal, NoSignalFromTheStartHasItsOwnWords) {
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

TEST_F(V4l2Signal, PictureThatChangesItsSizeIsOpenedAnew) {
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

TEST_F(V4l2Signal, SizeOfADigitalSignalIsFollowedWithAndWithoutAnEvent) {
  FakeV4l2Model model;
  model.dv_timings = true;
  begin(model);
  device_->run();
  const auto frame_of = [&](int width, int height) {
    return eventually([&] {
      const FrameLease lease = source_->wait(20ms);
      return lease && lease.info().format.width == width && lease.info().format.height == height;
    });
  };
  ASSERT_TRUE(frame_of(64, 48)) << source_->describe();
  device_->set_signal(0, 128, 96);
  EXPECT_TRUE(frame_of(128, 96)) << source_->describe();
  device_->set_signal(0, 32, 32);
  device_->change_source();
  EXPECT_TRUE(frame_of(32, 32)) << source_->describe();
  EXPECT_EQ(source_->counters().reconnects, 2U);
  device_->hush();
}

TEST_F(V4l2Signal, DigitalInputSaysWhatIsWrongWithItsSignal) {
  for (const auto& [error, words] :
       {std::pair(ENOLINK, "HDMI 0 has no signal"), std::pair(ENOLCK, "HDMI 0 finds no lock"),
        std::pair(ERANGE, "HDMI 0 has a signal that the device cannot take")}) {
    FakeV4l2Model model;
    model.dv_timings = true;
    begin(model);
    device_->run();
    ASSERT_TRUE(next());
    device_->set_signal(error, 0, 0);
    EXPECT_TRUE(says(words)) << source_->describe();
    EXPECT_TRUE(state_becomes(SourceState::no_signal));
    device_->set_signal(0, 80, 60);  // another picture when it is back
    EXPECT_TRUE(eventually([&] {
      const FrameLease lease = source_->wait(20ms);
      return lease && lease.info().format.width == 80;
    })) << source_->describe();
    device_->hush();
  }
}

}  // namespace
}  // namespace lightwell::test
