// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// What cameras of GenICam can do beyond sending frames: say of each what it was, wait for a trigger, keep a shared clock.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <thread>

#include "daemon/capture/capture_source.h"
#include "tests/integration/capture/fake_camera.h"
#include "tests/support/eventually.h"
#include "tests/support/private_network.h"

namespace lightwell::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class AravisFeatures : public testing::Test {
 protected:
  void SetUp() override {
    if (!PrivateNetwork::reason().empty()) GTEST_SKIP() << PrivateNetwork::reason();
  }
  void begin(const CaptureOptions& options, std::uint64_t first_id = 1) {
    camera_.emplace(first_id);
    ASSERT_TRUE(camera_->ready());
    source_ = std::move(make_capture_source("aravis:127.0.0.1", options)).value();
    ASSERT_TRUE(source_->start());
  }
  FrameLease next() {
    FrameLease lease;
    eventually([&] { return static_cast<bool>(lease = source_->wait(100ms)); });
    return lease;
  }
  bool says(const std::string& words) {
    return eventually([&] {
      static_cast<void>(source_->wait(0ms));
      return source_->describe().find(words) != std::string::npos;
    });
  }
  static unsigned picture(const FrameLease& lease) {
    return std::to_integer<unsigned>(lease.bytes().front());
  }

  std::optional<FakeCamera> camera_;
  std::unique_ptr<CaptureSource> source_;
};

TEST_F(AravisFeatures, EachFrameHasItsOwnExposureAndGain) {
  begin({});
  for (int i = 0; i < 40; ++i) {
    const FrameLease lease = next();
    ASSERT_TRUE(lease) << source_->describe();
    // The picture counts modulo 256, the exposure without end, from 1000 µs on; the register says 500 µs.
    const auto n = static_cast<unsigned>(lease.info().exposure_us - 1000);
    EXPECT_GE(lease.info().exposure_us, 1000);
    EXPECT_EQ(n % 256, picture(lease));
    EXPECT_DOUBLE_EQ(lease.info().gain_db, n % 8);
    EXPECT_EQ(lease.bytes().size(), 64U * 48U);
  }
}

TEST_F(AravisFeatures, TriggeredCameraSendsAFrameAnEdgeAndMayRest) {
  CaptureOptions options;
  options.trigger = "Line0";
  options.rate_hz = 100;  // sets what ends triggering, before the trigger
  options.trigger_rate_hz = 24;
  begin(options);
  ASSERT_TRUE(says("has sent no frame yet: it is triggered by Line0")) << source_->describe();
  EXPECT_FALSE(source_->wait(200ms));
  for (unsigned i = 0; i < 5; ++i) {
    camera_->tell("trigger");
    const FrameLease lease = next();
    ASSERT_TRUE(lease) << source_->describe();
    EXPECT_EQ(picture(lease), i);
    EXPECT_EQ(lease.info().sequence, i);
  }
  EXPECT_TRUE(says("24 Hz at most, exposure 0.5 ms, triggered by Line0")) << source_->describe();
  EXPECT_DOUBLE_EQ(source_->rate_hz(), 24);
  // Longer than a free-running camera may be silent: nobody opens this one anew.
  std::this_thread::sleep_for(1500ms);
  EXPECT_EQ(source_->state(), SourceState::streaming);
  camera_->tell("trigger");
  EXPECT_TRUE(next());
  EXPECT_EQ(source_->counters().reconnects, 0U);
  EXPECT_EQ(source_->counters().lost, 0U);
}

TEST_F(AravisFeatures, FirstInputIsTakenWhereAnyWillDo) {
  CaptureOptions options;
  options.trigger = "any";
  begin(options);
  ASSERT_TRUE(says("triggered by Line0")) << source_->describe();
  camera_->tell("trigger");
  EXPECT_TRUE(next());
}

TEST_F(AravisFeatures, InputThatTheCameraLacksIsNamedWithThoseItHas) {
  CaptureOptions options;
  options.trigger = "Line9";
  begin(options);
  EXPECT_TRUE(says("trigger = \"Line9\": the camera has Software, Line0, Line2")) << source_->describe();
  EXPECT_EQ(source_->state(), SourceState::opening);
}

TEST_F(AravisFeatures, TriggerThatSomebodyLeftOnIsEnded) {
  CaptureOptions options;
  options.trigger = "Line0";
  begin(options);
  ASSERT_TRUE(says("triggered by Line0")) << source_->describe();
  source_->stop();
  source_ = std::move(make_capture_source("aravis:127.0.0.1", {})).value();
  ASSERT_TRUE(source_->start());
  EXPECT_TRUE(says("triggered by Line0")) << "as the camera has it: " << source_->describe();
  source_->stop();
  options.trigger = "off";
  source_ = std::move(make_capture_source("aravis:127.0.0.1", options)).value();
  ASSERT_TRUE(source_->start());
  EXPECT_TRUE(next()) << source_->describe();
}

TEST_F(AravisFeatures, SharedClockIsSaid) {
  CaptureOptions options;
  options.ptp = true;
  begin(options);
  EXPECT_TRUE(says("(PTP Slave")) << source_->describe();
}

TEST_F(AravisFeatures, IdsOfSixtyFourBitsAreCountedAcrossThirtyTwo) {
  begin({}, (std::uint64_t{1} << 32) - 5);
  std::uint64_t least = 0;
  for (int i = 0; i < 20; ++i) {
    const FrameLease lease = next();
    ASSERT_TRUE(lease) << source_->describe();
    EXPECT_GE(lease.info().sequence, least);
    least = lease.info().sequence + 1;
  }
  const std::uint64_t lost = source_->counters().lost;
  EXPECT_LT(lost, 100U);
  camera_->tell("skip 70000");  // more than sixteen bits can tell
  EXPECT_TRUE(eventually([&] {
    static_cast<void>(source_->wait(10ms));
    return source_->counters().lost >= lost + 70000;
  }));
}

}  // namespace
}  // namespace lightwell::test
