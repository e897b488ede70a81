// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/publish/publisher.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/dds.h"
#include "tests/support/fake_daemon.h"

namespace lightwell {
namespace {

using namespace std::chrono_literals;
using test::publish;

constexpr auto kPatience = 20s;  // longer than anything here takes on a busy machine

class PublisherTest : public testing::Test {
 protected:
  std::unique_ptr<Publisher> start(double environment_hz = 1000) {
    return Publisher::start({.probe = "test", .dds = test::own_domain(), .environment_hz = environment_hz},
                            channel_, control_)
        .value();
  }
  std::shared_ptr<DdsDomain> domain_ = DdsDomain::open(test::own_domain()).value();
  SnapshotChannel channel_{test::snapshot_shape()};
  test::FakeControl control_;
};

TEST_F(PublisherTest, EveryFrameReachesAReaderThatKeepsUp) {
  const auto reader = LightReader::create(domain_).value();
  const auto publisher = start();
  LightFrame frame;
  for (std::uint64_t number = 1; number <= 20; ++number) {
    publish(channel_, number);
    ASSERT_TRUE(reader->take(frame, kPatience)) << reader->refusal();
    EXPECT_EQ(frame.header.number, number);
    EXPECT_EQ(frame.header.sequence, 1000 + number);
  }
  const auto lease = channel_.wait_newer(0, 0ms);
  EXPECT_EQ(frame.header.probe, "test");
  EXPECT_EQ(frame.header.calibration_id, "0123456789abcdef");
  EXPECT_EQ(frame.header.capture_mono_ns, lease->capture_mono_ns);
  EXPECT_EQ(frame.header.measured_part, lease->map.coverage);
  EXPECT_TRUE(frame.has_parents);
  ASSERT_EQ(frame.lights.size(), lease->lights.size());
  EXPECT_EQ(frame.lights[5].direction, lease->lights[5].direction);
  EXPECT_TRUE((frame.lights[5].illuminance == lease->lights[5].illuminance).all());
  EXPECT_EQ(frame.lights[5].predicted_error, lease->lights[5].predicted_error);
  EXPECT_GT(frame.lights[5].predicted_error, 0);
  EXPECT_TRUE((frame.light_set().total_illuminance == lease->total_illuminance).all());
}

TEST_F(PublisherTest, LateReaderGetsTheLastLightsThoughNoNewOnesCome) {
  const auto publisher = start();
  publish(channel_, 7);
  {
    const auto early = LightReader::create(domain_).value();
    LightFrame frame;
    ASSERT_TRUE(early->take(frame, kPatience));
  }
  const auto late = LightReader::create(domain_).value();
  LightFrame frame;
  ASSERT_TRUE(late->take(frame, kPatience));
  EXPECT_EQ(frame.header.number, 7u);
  EXPECT_EQ(publisher->counters().lights, 1u) << "a repeat is not a frame";
}

TEST_F(PublisherTest, MapsAndStatusArriveToo) {
  control_.change([](DaemonStatus& status) {
    status.source = "simulated:day";
    status.source_state = SourceState::stalled;
    status.capture.lost = 5;
    status.alarm = "frames do not arrive";
  });
  const auto publisher = start();
  publish(channel_, 3);
  const auto maps = EnvironmentReader::create(domain_).value();
  EnvironmentFrame map;
  ASSERT_TRUE(maps->take(map, kPatience));
  EXPECT_EQ(map.header.number, 3u);
  const auto lease = channel_.wait_newer(0, 0ms);
  EXPECT_EQ(map.map.grid.rings, lease->map.grid.rings);
  for (std::size_t i = 0; i < map.map.radiance.size(); ++i)
    ASSERT_NEAR(map.map.radiance[i], lease->map.radiance[i],
                lease->map.radiance[i] * 0x1p-11f);  // half: 11 bits
  const auto statuses = StatusReader::create(domain_).value();
  ProbeStatus status;
  ASSERT_TRUE(statuses->take(status, kPatience));
  EXPECT_EQ(status.probe, "test");
  EXPECT_EQ(status.source, "simulated:day");
  EXPECT_EQ(status.source_state, name(SourceState::stalled));
  EXPECT_EQ(status.lost, 5u);
  EXPECT_EQ(status.alarm, "frames do not arrive");
}

TEST_F(PublisherTest, HarmonicsComeWithTheLights) {
  const auto reader = LightReader::create(domain_).value();
  const auto publisher = start();
  publish(channel_, 1);
  LightFrame frame;
  ASSERT_TRUE(reader->take(frame, kPatience)) << reader->refusal();
  const auto lease = channel_.wait_newer(0, 0ms);
  ASSERT_EQ(frame.harmonics.size(), 25u);
  for (std::size_t i = 0; i < 25; ++i) EXPECT_TRUE((frame.harmonics[i] == lease->harmonics[i]).all());
}

TEST_F(PublisherTest, FitsReachEvenALateReader) {
  const auto publisher = start();
  publish(channel_, 9);
  const auto lease = channel_.wait_newer(0, 0ms);
  FitSnapshot fit;
  fit.number = 9;
  fit.sequence = 1009;
  fit.fit = fit_few_lights(lease->map, {.lights = 3}).value();
  publisher->send(fit);
  const auto reader = FitReader::create(domain_).value();
  FitFrame frame;
  ASSERT_TRUE(reader->take(frame, kPatience)) << reader->refusal();
  EXPECT_EQ(frame.header.probe, "test");
  EXPECT_EQ(frame.header.number, 9u);
  EXPECT_EQ(frame.header.sequence, 1009u);
  EXPECT_EQ(frame.residual, static_cast<float>(fit.fit.residual));
  const LightSet sent = light_set(fit.fit), received = frame.light_set();
  EXPECT_EQ(received.method, "fit");
  ASSERT_EQ(received.lights.size(), sent.lights.size());
  ASSERT_GE(sent.lights.size(), 1u);
  for (std::size_t i = 0; i < sent.lights.size(); ++i) {
    EXPECT_EQ(received.lights[i].direction, sent.lights[i].direction);
    EXPECT_TRUE((received.lights[i].illuminance == sent.lights[i].illuminance).all());
    EXPECT_EQ(received.lights[i].id, sent.lights[i].id);
  }
  EXPECT_TRUE((received.ambient == sent.ambient).all());
  EXPECT_EQ(publisher->counters().fits, 1u);
}

TEST_F(PublisherTest, NoMapsWhereNoneAreWanted) {
  const auto publisher = start(0);
  const auto lights = LightReader::create(domain_).value();
  LightFrame frame;
  for (std::uint64_t number = 1; number <= 5; ++number) {
    publish(channel_, number);
    ASSERT_TRUE(lights->take(frame, kPatience));
  }
  EXPECT_EQ(publisher->counters().environments, 0u);
  EXPECT_EQ(publisher->counters().dropped, 0u);
}

TEST_F(PublisherTest, StopsThoughNothingEverCameAndThoughTheChannelIsClosed) {
  start().reset();
  channel_.close();
  start().reset();
}

TEST_F(PublisherTest, WrongInterfaceIsNamed) {
  const auto failed = Publisher::start({.dds = {.interface = "nosuch0"}}, channel_, control_);
  ASSERT_FALSE(failed);
  EXPECT_THAT(failed.error().message, testing::HasSubstr("nosuch0"));
}

}  // namespace
}  // namespace lightwell
