// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/tracking_stream.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmath>
#include <string>
#include <vector>

#include "interface/freed_packet.h"
#include "render/tracked_camera.h"

namespace lightwell::render {
namespace {

// A message from x metres along the stage's first axis.
std::vector<std::uint8_t> at(double x_m, std::uint32_t zoom) {
  FreedPacket packet;
  packet.camera.position_m.x() = x_m;
  packet.zoom = zoom;
  return freed_message(packet);
}

TEST(Tracking, TheScenesCameraStandsWhereTheTrackedOneDoes) {
  TrackedCamera tracked;
  tracked.position_m = {1, 2, 3};
  tracked.stage_from_camera = rotation_from_pan_tilt_roll(-90, 0, 0);
  SceneCamera camera;
  camera.yfov_rad = 0.7f;
  const SceneCamera placed = tracked_camera(tracked, camera);
  EXPECT_LE((placed.world_from_camera.col(3).head<3>() - Vec3f(1, 3, -2)).norm(), 1e-6f);
  // The camera looks along its −Z: panned to the right, along +X.
  EXPECT_LE((-placed.world_from_camera.col(2).head<3>() - Vec3f(1, 0, 0)).norm(), 1e-6f);
  EXPECT_EQ(placed.yfov_rad, 0.7f) << "the stream tells no lens";
  tracked.focal_length_mm = 24;
  EXPECT_EQ(tracked_camera(tracked, camera).yfov_rad, 0.7f) << "nor does half of one";
  tracked.sensor_height_mm = 24;
  EXPECT_FLOAT_EQ(tracked_camera(tracked, camera).yfov_rad, static_cast<float>(2 * std::atan(0.5)));
}

TEST(Tracking, TheFreshestPacketIsThePoseAndMalformedOnesChangeNothing) {
  TrackingOptions options;
  options.protocol = TrackingProtocol::freed;
  options.address = {"127.0.0.1", 0};
  options.freed_mm_per_unit = 0.01;
  options.sensor_height_mm = 20;
  auto stream = TrackingStream::open(options);
  ASSERT_TRUE(stream.ok()) << stream.error().message;
  EXPECT_FALSE(stream->update());
  EXPECT_FALSE(stream->camera());
  const int sender = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(stream->port());
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const auto send = [&](const std::vector<std::uint8_t>& bytes) {
    ::sendto(sender, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&to), sizeof to);
  };
  // Loopback delivers in order before sendto returns.
  send(at(1, 1000));
  send(at(2, 2500));
  send({1, 2, 3});
  EXPECT_TRUE(stream->update());
  ASSERT_TRUE(stream->camera());
  EXPECT_DOUBLE_EQ(stream->camera()->position_m.x(), 2);
  EXPECT_DOUBLE_EQ(*stream->camera()->focal_length_mm, 25);
  EXPECT_EQ(stream->malformed(), 1u);
  send({});
  EXPECT_FALSE(stream->update());
  EXPECT_DOUBLE_EQ(stream->camera()->position_m.x(), 2) << "the last pose is kept";
  EXPECT_EQ(stream->malformed(), 2u);
  ::close(sender);
}

TEST(Tracking, OfTwoCamerasAtOnePortOneIsFollowed) {
  for (const bool first : {true, false}) {
    TrackingOptions options;
    options.protocol = TrackingProtocol::freed;
    options.address = {"127.0.0.1", 0};
    if (!first) options.camera = 7;
    auto stream = TrackingStream::open(options);
    ASSERT_TRUE(stream.ok()) << stream.error().message;
    const int sender = ::socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(stream->port());
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    for (const std::uint8_t id : std::vector<std::uint8_t>{3, 7, 3, 7, 9}) {
      TrackedCamera camera;
      camera.position_m.x() = id;
      const auto bytes = freed_message({id, camera});
      ::sendto(sender, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&to), sizeof to);
    }
    EXPECT_TRUE(stream->update());
    EXPECT_DOUBLE_EQ(stream->camera()->position_m.x(), first ? 3 : 7);
    EXPECT_FALSE(stream->update());
    ::close(sender);
  }
}

TEST(Tracking, APortThatIsTakenIsAFailureThatNamesIt) {
  TrackingOptions options;
  options.address = {"127.0.0.1", 0};
  auto first = TrackingStream::open(options);
  ASSERT_TRUE(first.ok());
  options.address.port = first->port();
  const auto second = TrackingStream::open(options);
  ASSERT_FALSE(second.ok());
  EXPECT_EQ(second.error().kind, ErrorKind::failed);
  EXPECT_NE(second.error().message.find(std::to_string(first->port())), std::string::npos);
}

}  // namespace
}  // namespace lightwell::render
