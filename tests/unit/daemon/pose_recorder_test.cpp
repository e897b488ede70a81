// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/record/pose_recorder.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/support/eventually.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

TEST(PoseRecorder, WritesWhatIsWholeAndInOrderAndCountsTheRest) {
  const test::TemporaryFolder folder;
  const auto file = poses_beside(folder.path() / "a.walk.mkv");
  EXPECT_EQ(file.filename(), "a.walk.poses.csv");
  TrackingOptions options;
  options.address = {"127.0.0.1", 0};
  auto recorder = PoseRecorder::start(options, file);
  ASSERT_TRUE(recorder.ok()) << recorder.error().message;
  const int sender = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons((*recorder)->port());
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const auto send = [&](const std::vector<std::uint8_t>& bytes) {
    ::sendto(sender, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&to), sizeof to);
  };
  const auto sample = [](double x, std::int64_t sampled_ns) {
    TrackedCamera camera;
    camera.position_m = {x, 2, 3};
    camera.sampled_ns = sampled_ns;
    return opentrackio_datagram(camera, 0);
  };
  send(sample(1, 1000));
  send({1, 2, 3});
  send(sample(2, 3000));
  send(sample(9, 2000));  // overtaken
  send(sample(9, 3000));  // sent twice
  send(sample(3, 4000));
  EXPECT_TRUE(test::eventually([&] { return (*recorder)->poses() == 3; }));
  // Line by line: before it is closed.
  ASSERT_TRUE(read_poses(file).ok());
  EXPECT_EQ(read_poses(file)->poses.size(), 3u);
  EXPECT_TRUE((*recorder)->stop());
  ::close(sender);
  const auto& stats = (*recorder)->stats();
  EXPECT_EQ(stats.poses, 3u);
  EXPECT_EQ(stats.malformed, 1u);
  EXPECT_EQ(stats.out_of_order, 2u);
  EXPECT_EQ(*stats.first_malformed, "OpenTrackIO: no OTrk header (from 127.0.0.1)");
  EXPECT_LE((read_poses(file)->poses[2].pose.position_m - Vec3d(3, 3, -2)).norm(), 1e-7) << "stage to world";
}

}  // namespace
}  // namespace lightwell
