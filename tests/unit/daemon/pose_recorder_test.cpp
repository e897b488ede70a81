// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/record/pose_recorder.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <mutex>

#include "interface/freed_packet.h"
#include "tests/support/eventually.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

// A recorder on loopback and a socket that sends to it.
class PoseRecorderTest : public testing::Test {
 protected:
  void start(TrackingProtocol protocol, std::optional<int> camera = std::nullopt) {
    TrackingOptions options;
    options.protocol = protocol;
    options.address = {"127.0.0.1", 0};
    options.camera = camera;
    auto made = PoseRecorder::start(options, file_, [this](const std::string& line) {
      const std::scoped_lock lock(mutex_);
      remarks_.push_back(line);
    });
    ASSERT_TRUE(made.ok()) << made.error().message;
    recorder_ = *std::move(made);
    to_.sin_family = AF_INET;
    to_.sin_port = htons(recorder_->port());
    to_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  }
  ~PoseRecorderTest() override { ::close(socket_); }
  void send(const std::vector<std::uint8_t>& bytes) const {
    ::sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to_), sizeof to_);
  }
  void send_sample(double x, std::int64_t sampled_ns) const {
    TrackedCamera camera;
    camera.position_m = {x, 2, 3};
    camera.sampled_ns = sampled_ns;
    send(opentrackio_datagram(camera, 0));
  }
  void send_freed(std::uint8_t id, double x) const {
    TrackedCamera camera;
    camera.position_m = {x, 0, 0};
    send(freed_message({id, camera}));
  }
  [[nodiscard]] bool has_poses(std::uint64_t count) const {
    return test::eventually([&] { return recorder_->poses() == count; });
  }
  [[nodiscard]] std::vector<std::string> remarks() {
    const std::scoped_lock lock(mutex_);
    return remarks_;
  }
  // Ends it; the x of what was kept.
  [[nodiscard]] std::vector<double> kept_x() {
    EXPECT_TRUE(recorder_->stop());
    EXPECT_TRUE(recorder_->keep());
    std::vector<double> x;
    const auto file = read_poses(file_);
    EXPECT_TRUE(file.ok());
    for (const TimedPose& pose : file->poses) x.push_back(pose.pose.position_m.x());
    return x;
  }

  const test::TemporaryFolder folder_;
  const std::filesystem::path file_ = poses_beside(folder_.path() / "a.walk.mkv");

 private:
  std::mutex mutex_;
  std::vector<std::string> remarks_;
  sockaddr_in to_{};
  int socket_ = ::socket(AF_INET, SOCK_DGRAM, 0);

 protected:
  std::unique_ptr<PoseRecorder> recorder_;  // last: its thread adds remarks
};

TEST_F(PoseRecorderTest, WritesWhatIsWholeAndInOrderAndCountsTheRest) {
  EXPECT_EQ(file_.filename(), "a.walk.poses.csv");
  start(TrackingProtocol::opentrackio);
  send_sample(1, 1000);
  send({1, 2, 3});
  send_sample(2, 3000);
  send_sample(9, 2000);  // overtaken
  send_sample(9, 3000);  // sent twice
  send_sample(3, 4000);
  EXPECT_TRUE(has_poses(3));
  EXPECT_EQ(kept_x(), (std::vector<double>{1, 2, 3}));
  const auto& stats = recorder_->stats();
  EXPECT_EQ(stats.poses, 3u);
  EXPECT_EQ(stats.malformed, 1u);
  EXPECT_EQ(stats.out_of_order, 2u);
  EXPECT_EQ(stats.clock_steps, 0u);
  EXPECT_EQ(*stats.first_malformed, "OpenTrackIO: no OTrk header (from 127.0.0.1)");
  EXPECT_LE((read_poses(file_)->poses[2].pose.position_m - Vec3d(3, 3, -2)).norm(), 1e-7) << "stage to world";
}

TEST_F(PoseRecorderTest, GoesOnWhereTheTrackersClockIsSetBackAndSaysSo) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  start(TrackingProtocol::opentrackio);
  send_sample(1, 5000 * kSecond);
  send_sample(2, 5001 * kSecond);
  send_sample(3, 1400 * kSecond);  // one may be a stray
  send_sample(4, 1401 * kSecond);
  send_sample(5, 1402 * kSecond);
  EXPECT_TRUE(has_poses(4));
  EXPECT_EQ(remarks(),
            std::vector<std::string>{"the tracker's clock was set back by 3600.000 s after 2 poses"});
  EXPECT_EQ(kept_x(), (std::vector<double>{1, 2, 4, 5}));
  EXPECT_EQ(recorder_->stats().clock_steps, 1u);
  EXPECT_EQ(recorder_->stats().out_of_order, 1u);
}

TEST_F(PoseRecorderTest, FollowsTheFirstCameraOfAPortAndNamesTheOthers) {
  start(TrackingProtocol::freed);
  for (int i = 1; i <= 3; ++i) {
    send_freed(4, i);
    send_freed(7, -30);
  }
  send_freed(4, 4);
  EXPECT_TRUE(has_poses(4));
  EXPECT_EQ(remarks(),
            std::vector<std::string>{"camera 7 (from 127.0.0.1) is left out: camera 4 is followed"});
  EXPECT_EQ(kept_x(), (std::vector<double>{1, 2, 3, 4}));
  EXPECT_EQ(recorder_->stats().other_cameras, std::set<int>{7});
  EXPECT_EQ(recorder_->stats().camera, 4);
}

TEST_F(PoseRecorderTest, FollowsTheCameraThatIsAskedFor) {
  start(TrackingProtocol::freed, 7);
  send_freed(4, 1);
  send_freed(7, -30);
  send_freed(4, 2);
  send_freed(7, -31);
  EXPECT_TRUE(has_poses(2));
  EXPECT_EQ(kept_x(), (std::vector<double>{-30, -31}));
  EXPECT_EQ(recorder_->stats().other_cameras, std::set<int>{4});
}

TEST_F(PoseRecorderTest, ATrackerThatFallsSilentIsSaidAndSoIsItsReturn) {
  start(TrackingProtocol::freed);
  send_freed(1, 1);
  EXPECT_TRUE(has_poses(1));
  EXPECT_TRUE(test::eventually([&] { return !remarks().empty(); }));
  send_freed(1, 2);
  EXPECT_TRUE(has_poses(2));
  EXPECT_TRUE(test::eventually([&] { return remarks().size() == 2; }));
  EXPECT_EQ(kept_x(), (std::vector<double>{1, 2}));
  EXPECT_EQ(remarks()[0], "the tracker sends no poses any more");
  EXPECT_TRUE(remarks()[1].starts_with("poses come again, after ")) << remarks()[1];
  EXPECT_GT(recorder_->stats().longest_silence_s, 1);
}

}  // namespace
}  // namespace lightwell
