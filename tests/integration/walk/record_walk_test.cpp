// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <thread>

#include "interface/freed_packet.h"
#include "interface/pose_file.h"
#include "interface/recording.h"
#include "tests/integration/walk/walk_fixture.h"

namespace lightwell::test {
namespace {

using testing::HasSubstr;

class RecordWalk : public Walk {
 protected:
  // Where the camera says it was, by its truth, at mid-exposure.
  [[nodiscard]] std::vector<TimedPose> true_poses() const {
    std::vector<TimedPose> poses;
    std::ifstream file(truth());
    for (std::string line; std::getline(file, line);)
      if (const auto frame = nlohmann::json::parse(line, nullptr, false); !frame.is_discarded())
        poses.push_back({frame.at("time_ns").get<std::int64_t>(),
                         {rgb_of(frame.at("position_m")).matrix(), Eigen::Quaterniond::Identity()}});
    return poses;
  }
  // Distances of the track from the truth, median, metres.
  [[nodiscard]] double median_error_m(double lag_s) const {
    const auto file = read_poses(poses());
    EXPECT_TRUE(file.ok()) << file.error().message;
    const PoseTrack track(file->poses, {});
    std::vector<double> errors;
    for (const TimedPose& frame : true_poses())
      if (const auto at = track.at(frame.time_ns, lag_s); at.known == PoseTrack::Known::yes)
        errors.push_back((at.pose.position_m - frame.pose.position_m).norm());
    EXPECT_GE(errors.size(), 20u);
    if (errors.empty()) return 1e9;
    std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2),
                     errors.end());
    return errors[errors.size() / 2];
  }
  // The walk goes at half a metre a second: 60 ms are 30 mm, of which a quarter is what a busy machine may add.
  void expect_late_by_60_ms() const {
    EXPECT_LT(median_error_m(0.06), 0.0075);
    EXPECT_NEAR(median_error_m(0), 0.03, 0.0075);
  }
};

TEST_F(RecordWalk, PosesOfAnOpenTrackIoTrackerLieBesideTheTakeLateByItsLag) {
  const std::string tracker = "opentrackio:127.0.0.1:" + own_port();
  start_camera(
      {"--scenario", "walk", "--size", "160x120", "--tracking-out", tracker, "--tracking-lag", "60"});
  const auto recorded = record({"--seconds", "3", "--source", "aravis:" + address_, "--tracking", tracker});
  ASSERT_EQ(recorded.exit_code, 0) << recorded.err;
  const auto report = nlohmann::json::parse(recorded.out);
  EXPECT_EQ(report["poses"]["file"], poses().string());
  EXPECT_GT(report["poses"]["poses"], 100);
  EXPECT_EQ(report["poses"]["malformed"], 0);
  EXPECT_TRUE(read_poses(poses())->by_tracker_clock);
  expect_late_by_60_ms();
}

TEST_F(RecordWalk, PosesOfAFreeDTrackerAreRecordedThroughTheDaemon) {
  const std::string tracker = "freed:127.0.0.1:" + own_port();
  start_camera({"--scenario", "walk", "--size", "160x120", "--tracking-out", tracker, "--tracking-lag", "60",
                "--tracking-rate", "60"});
  start_daemon();
  ASSERT_TRUE(published_reaches(1)) << daemon_->stderr_text();
  const auto recorded = record({"--seconds", "3", "--daemon", http_, "--tracking", tracker});
  ASSERT_EQ(recorded.exit_code, 0) << recorded.err;
  EXPECT_TRUE(std::filesystem::exists(take()));
  EXPECT_FALSE(read_poses(poses())->by_tracker_clock) << "FreeD tells no times";
  expect_late_by_60_ms();
}

TEST_F(RecordWalk, ASimulatedWalkBringsTheExactPosesOfItsFrames) {
  const auto recorded = record({"--seconds", "1", "--source", "simulated:walk"});
  ASSERT_EQ(recorded.exit_code, 0) << recorded.err;
  const auto file = read_poses(poses());
  ASSERT_TRUE(file.ok()) << file.error().message;
  const auto reader = RecordingReader::open(take());
  ASSERT_TRUE(reader.ok());
  std::size_t frames = 0;
  std::size_t pose = 0;
  for (auto frame = (*reader)->skip(); frame && *frame; frame = (*reader)->skip(), ++frames) {
    while (pose < file->poses.size() && file->poses[pose].time_ns < (*frame)->capture_mono_ns) ++pose;
    ASSERT_LT(pose, file->poses.size());
    EXPECT_EQ(file->poses[pose].time_ns, (*frame)->capture_mono_ns);
  }
  EXPECT_GE(frames, 5u);
}

TEST_F(RecordWalk, ATakeWithoutATrackerSaysSoAndLeavesNoPoseFile) {
  const auto recorded = record(
      {"--seconds", "0.5", "--source", "simulated:walk", "--tracking", "freed:127.0.0.1:" + own_port()});
  EXPECT_EQ(recorded.exit_code, 1);
  EXPECT_THAT(recorded.err, HasSubstr("no pose came; the take " + take().string() + " is without"));
  EXPECT_TRUE(std::filesystem::exists(take()));
  EXPECT_FALSE(std::filesystem::exists(poses()));
}

// A tracker of its own: FreeD messages of one camera, 50 a second, for as long as this lives.
class FreedCamera {
 public:
  FreedCamera(const std::string& port, std::uint8_t id, double x)
      : thread_([this, port, id, x] {
          const int socket = ::socket(AF_INET, SOCK_DGRAM, 0);
          sockaddr_in to{};
          to.sin_family = AF_INET;
          to.sin_port = htons(static_cast<std::uint16_t>(std::stoi(port)));
          to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
          TrackedCamera camera;
          camera.position_m.x() = x;
          const auto bytes = freed_message({id, camera});
          while (running_) {
            ::sendto(socket, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to),
                     sizeof to);
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
          }
          ::close(socket);
        }) {}
  ~FreedCamera() {
    running_ = false;
    thread_.join();
  }

 private:
  std::atomic<bool> running_ = true;
  std::thread thread_;
};

TEST_F(RecordWalk, OfTwoCamerasAtOnePortTheOneThatIsAskedForIsRecordedAndItsEndIsSaid) {
  const std::string port = own_port();
  auto four = std::make_unique<FreedCamera>(port, 4, 1.0);
  const FreedCamera seven(port, 7, -30.0);
  std::thread end([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));
    four.reset();
  });
  const auto recorded = record({"--seconds", "4", "--source", "simulated:walk", "--tracking",
                                "freed:127.0.0.1:" + port, "--tracking-camera", "4"});
  end.join();
  ASSERT_EQ(recorded.exit_code, 0) << recorded.err;
  EXPECT_THAT(recorded.err, HasSubstr("camera 7 (from 127.0.0.1) is left out: camera 4 is followed"));
  EXPECT_THAT(recorded.err, HasSubstr("the tracker sends no poses any more"));
  EXPECT_THAT(recorded.err, HasSubstr("the tracker was silent for the last "));
  const auto file = read_poses(poses());
  ASSERT_TRUE(file.ok());
  for (const TimedPose& pose : file->poses) EXPECT_EQ(pose.pose.position_m.x(), 1);
  const auto none =
      run_process(program("lightwell"),
                  {"record", "--out", (folder_.path() / "none.mkv").string(), "--seconds", "0.5", "--source",
                   "simulated:walk", "--tracking", "freed:127.0.0.1:" + port, "--tracking-camera", "4"});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, HasSubstr("no pose came of camera 4, but of 7"));
}

TEST_F(RecordWalk, ATakeThatCameToNothingStandsInNobodysWay) {
  // A disk that is full before the take's first frame, which has 640 × 480 pixels of two bytes, is written.
  ChildProcess::Options full;
  full.file_bytes = 100'000;
  ChildProcess none({program("lightwell"), "record", "--source", "simulated:walk", "--seconds", "1", "--out",
                     take().string()},
                    folder_.path() / "stderr", full);
  EXPECT_EQ(none.wait_for_end(), 1) << none.stderr_text();
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
    EXPECT_THAT(entry.path().filename().string(), testing::Not(HasSubstr("take"))) << none.stderr_text();
  const auto again = record({"--seconds", "0.5", "--source", "simulated:walk"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_TRUE(std::filesystem::exists(poses()));
}

TEST_F(RecordWalk, APoseFileThatIsThereIsNotOverwritten) {
  std::ofstream(poses()) << "mine\n";
  const auto recorded = record({"--seconds", "0.5", "--source", "simulated:walk"});
  EXPECT_EQ(recorded.exit_code, 1);
  EXPECT_THAT(recorded.err, HasSubstr(poses().string() + ": exists already and is not overwritten"));
  EXPECT_FALSE(std::filesystem::exists(take()));
  std::string mine;
  std::ifstream(poses()) >> mine;
  EXPECT_EQ(mine, "mine");
}

TEST_F(RecordWalk, WrongTrackersAreNamed) {
  const auto refused = [&](Words more, int code, const char* text) {
    for (const char* word : {"--seconds", "1"}) more.emplace_back(word);
    const auto result = record(more);
    EXPECT_EQ(result.exit_code, code);
    EXPECT_THAT(result.err, HasSubstr(text));
    EXPECT_FALSE(std::filesystem::exists(poses()));
  };
  refused({"--source", "simulated:walk", "--tracking", "vrpn:1.2.3.4:5"}, 2, "--tracking vrpn:1.2.3.4:5");
  refused({"--source", "simulated:walk", "--tracking", "freed:203.0.113.7:5000"}, 1, "203.0.113.7");
  refused({"--daemon", "203.0.113.7:8650", "--tracking", "freed:127.0.0.1:0"}, 2,
          "--daemon 203.0.113.7:8650");
  const auto still =
      run_process(program("lightwell-camera"), {"--address", address_, "--scenario", "day", "--seconds", "1",
                                                "--tracking-out", "freed:127.0.0.1:6301"});
  EXPECT_EQ(still.exit_code, 2);
  EXPECT_THAT(still.err, HasSubstr("--scenario walk"));
}

}  // namespace
}  // namespace lightwell::test
