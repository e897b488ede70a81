// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The GigE Vision source against cameras that die, fall silent, lose packets, come late, come back different.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <vector>

#include "daemon/capture/capture_source.h"
#include "daemon/capture/gvcp.h"
#include "tests/integration/capture/fake_camera.h"
#include "tests/support/eventually.h"
#include "tests/support/private_network.h"

namespace lightwell::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr const char* kAddress = "127.0.0.1";

class AravisFaults : public testing::Test {
 protected:
  void SetUp() override {
    if (!PrivateNetwork::reason().empty()) GTEST_SKIP() << PrivateNetwork::reason();
  }
  void TearDown() override {
    if (source_ != nullptr) source_->stop();
  }
  void camera(int width = 64, int height = 48, double rate_hz = 100, const std::string& serial = "TEST") {
    camera_.emplace(width, height, rate_hz, serial);
    ASSERT_TRUE(camera_->ready());
  }
  static std::unique_ptr<CaptureSource> source(const CaptureOptions& options = {}) {
    auto made = make_capture_source(std::string("aravis:") + kAddress, options);
    auto result = std::move(made).value();
    EXPECT_TRUE(result->start());
    return result;
  }
  // Takes frames until one of them satisfies the condition.
  template <class Condition>
  bool frame_where(Condition condition) {
    return eventually([&] {
      const FrameLease lease = source_->wait(100ms);
      if (!lease) return false;
      EXPECT_GE(lease.info().sequence, next_sequence_);
      next_sequence_ = lease.info().sequence + 1;
      return condition(lease);
    });
  }
  bool frame() {
    return frame_where([](const FrameLease&) { return true; });
  }
  bool state_becomes(SourceState state) {
    return eventually([&] {
      const FrameLease lease = source_->wait(0ms);
      if (lease) next_sequence_ = lease.info().sequence + 1;
      return source_->state() == state;
    });
  }

  std::optional<FakeCamera> camera_;
  std::unique_ptr<CaptureSource> source_;
  std::uint64_t next_sequence_ = 0;  // smallest that may come
};

TEST_F(AravisFaults, CameraThatComesLateIsFound) {
  source_ = source();
  ASSERT_TRUE(eventually([&] { return source_->describe().find("no camera answers") != std::string::npos; }));
  EXPECT_EQ(source_->state(), SourceState::no_device);
  EXPECT_THAT(source_->describe(), HasSubstr(kAddress));
  camera();
  EXPECT_TRUE(frame());
  EXPECT_TRUE(eventually([&] {
    return source_->describe().find("64×48 Mono8, 100 Hz") != std::string::npos;
  })) << source_->describe();
  EXPECT_EQ(source_->counters().reconnects, 0U);
}

TEST_F(AravisFaults, KilledAndRestartedCameraIsFoundAgain) {
  camera();
  source_ = source();
  ASSERT_TRUE(frame());
  camera_->kill();
  EXPECT_TRUE(state_becomes(SourceState::stalled));
  EXPECT_TRUE(state_becomes(SourceState::no_device));
  camera();
  EXPECT_TRUE(frame());
  EXPECT_EQ(source_->state(), SourceState::streaming);
  EXPECT_EQ(source_->counters().reconnects, 1U);
}

TEST_F(AravisFaults, CameraRestartedAtOnceIsFoundAgain) {
  camera();
  source_ = source();
  ASSERT_TRUE(frame());
  camera();  // the old one is gone, the new one knows nothing of us
  EXPECT_TRUE(eventually([&] { return frame() && source_->counters().reconnects == 1; }));
}

TEST_F(AravisFaults, CameraOfAnotherSizeIsTakenOverAndOldLeasesStayValid) {
  camera(64, 48);
  source_ = source();
  FrameLease old;
  ASSERT_TRUE(eventually([&] { return static_cast<bool>(old = source_->wait(100ms)); }));
  const std::vector<std::byte> bytes(old.bytes().begin(), old.bytes().end());
  camera(80, 100, 50, "OTHER");
  EXPECT_TRUE(frame_where([](const FrameLease& lease) {
    return lease.info().format.width == 80 && lease.info().format.height == 100 &&
           lease.bytes().size() == 8000;
  }));
  EXPECT_TRUE(eventually([&] { return source_->describe().find("OTHER") != std::string::npos; }));
  EXPECT_DOUBLE_EQ(source_->rate_hz(), 50);
  EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), old.bytes().begin(), old.bytes().end()));
  EXPECT_EQ(old.info().format.width, 64);
}

TEST_F(AravisFaults, SilentCameraIsStalledUntilItSendsAgain) {
  camera();
  source_ = source();
  ASSERT_TRUE(frame());
  camera_->tell("silent");
  EXPECT_TRUE(state_becomes(SourceState::stalled));
  EXPECT_TRUE(eventually([&] { return source_->describe().find("sends no frames") != std::string::npos; }))
      << source_->describe();
  camera_->tell("resume");
  EXPECT_TRUE(frame());
  EXPECT_TRUE(state_becomes(SourceState::streaming));
}

TEST_F(AravisFaults, CameraThatStoppedByItselfIsStartedAgain) {
  camera();
  source_ = source();
  ASSERT_TRUE(frame());
  camera_->tell("stop");
  ASSERT_TRUE(state_becomes(SourceState::stalled));
  EXPECT_TRUE(eventually([&] { return frame() && source_->counters().reconnects == 1; }));
}

TEST_F(AravisFaults, SlowCameraKeepsItsConnection) {
  camera(64, 48, 100);
  source_ = source();
  ASSERT_TRUE(frame());
  camera_->tell("slow 400");  // promises 10 ms, takes 400
  for (int i = 0; i < 6; ++i) EXPECT_TRUE(frame());
  EXPECT_EQ(source_->counters().reconnects, 0U);
  EXPECT_EQ(source_->counters().lost, 0U);
}

TEST_F(AravisFaults, LostPacketsMakeIncompleteFramesThatNobodySees) {
  camera(256, 256, 100);       // 8 packets
  camera_->tell("loss 0.05");  // a frame is whole with probability 0.95^10 = 0.6
  source_ = source();
  for (int i = 0; i < 50; ++i) {
    ASSERT_TRUE(frame_where([](const FrameLease& lease) {
      // Every byte of a frame is its number: a missing packet would show bytes of another.
      const std::byte first = lease.bytes().front();
      EXPECT_TRUE(lease.info().complete);
      EXPECT_TRUE(
          std::all_of(lease.bytes().begin(), lease.bytes().end(), [&](std::byte b) { return b == first; }));
      return true;
    }));
  }
  const CaptureCounters c = source_->counters();
  EXPECT_GT(c.incomplete, 0U);
  EXPECT_EQ(c.reconnects, 0U);
  // What was sent is what came whole, came incomplete, or was lost with its leader.
  EXPECT_GE(c.received + c.incomplete + c.lost, next_sequence_ - 1);
}

TEST_F(AravisFaults, CameraUnderSomebodyElsesControlSaysSo) {
  camera();
  const auto other = source();
  ASSERT_TRUE(eventually([&] { return static_cast<bool>(other->wait(100ms)); }));
  source_ = source();
  ASSERT_TRUE(eventually([&] {
    return source_->describe().find("another program has control") != std::string::npos;
  })) << source_->describe();
  EXPECT_NE(source_->state(), SourceState::streaming);
  other->stop();
  EXPECT_TRUE(frame());
}

TEST_F(AravisFaults, SettingsAreAppliedAndReadBack) {
  camera();
  CaptureOptions options;
  options.width = 128;
  options.height = 100;
  options.pixel_format = "Mono16";
  options.rate_hz = 40;
  options.exposure_us = 5000;
  source_ = source(options);
  EXPECT_TRUE(frame_where([](const FrameLease& lease) {
    EXPECT_EQ(lease.info().format, (FrameFormat{128, 100, PixelFormat::mono16}));
    EXPECT_DOUBLE_EQ(lease.info().exposure_us, 5000);
    return true;
  }));
  EXPECT_DOUBLE_EQ(source_->rate_hz(), 40);
}

TEST_F(AravisFaults, RefusedSettingIsNamedAndTriedAgain) {
  camera();
  CaptureOptions options;
  options.width = 5000;  // the sensor has 2048
  source_ = source(options);
  ASSERT_TRUE(eventually([&] { return source_->describe().find("5000") != std::string::npos; }))
      << source_->describe();
  EXPECT_THAT(source_->describe(), HasSubstr("Width"));
  EXPECT_EQ(source_->state(), SourceState::opening);
}

TEST_F(AravisFaults, ChangedExposureIsNoticed) {
  camera();
  source_ = source();
  ASSERT_TRUE(frame_where([](const FrameLease& lease) { return lease.info().exposure_us == 1000; }));
  camera_->tell("exposure 3000");
  EXPECT_TRUE(frame_where([](const FrameLease& lease) { return lease.info().exposure_us == 3000; }));
}

TEST_F(AravisFaults, ExposureIsChangedWhileFramesComeAndComesBackWithTheCamera) {
  source_ = source();
  EXPECT_EQ(source_->set_exposure_us(3000), ExposureChange::not_now);
  camera();
  ASSERT_TRUE(frame_where([](const FrameLease& lease) { return lease.info().exposure_us == 1000; }));
  ASSERT_EQ(source_->set_exposure_us(3000), ExposureChange::asked);
  ASSERT_TRUE(frame_where([](const FrameLease& lease) { return lease.info().exposure_us == 3000; }));
  camera_.reset();
  ASSERT_TRUE(eventually([&] { return source_->state() != SourceState::streaming; }));
  camera();
  EXPECT_TRUE(frame_where([](const FrameLease& lease) { return lease.info().exposure_us == 3000; }));
}

TEST_F(AravisFaults, DeviceIsDiscoveredAndItsControlSeen) {
  camera(64, 48, 100, "SERIAL7");
  const auto found = gvcp_discover(300ms);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].address, kAddress);
  EXPECT_EQ(found[0].serial, "SERIAL7");
  EXPECT_EQ(gvcp_read_register(kAddress, kGvcpControlPrivilege, 300ms), 0U);
  source_ = source();
  ASSERT_TRUE(frame());
  EXPECT_NE(gvcp_read_register(kAddress, kGvcpControlPrivilege, 300ms).value_or(0), 0U);
}

}  // namespace
}  // namespace lightwell::test
