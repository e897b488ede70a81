// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// lightwell-sync-simulator in virtual time: what the board says, held against the world it was told to live in.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "firmware/core/settings.h"
#include "interface/sync_frame.h"

namespace {

class Simulator {
 public:
  explicit Simulator(std::vector<std::string> words) {
    words.insert(words.begin(), LIGHTWELL_BIN_DIR "/lightwell-sync-simulator");
    std::vector<char*> argv;
    for (auto& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    int ends[2];
    EXPECT_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends), 0);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    EXPECT_EQ(posix_spawn(&process_, argv[0], &actions, nullptr, argv.data(), environ), 0);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    line = ends[0];
    frame_receiver_init(&receiver_);
  }
  ~Simulator() {
    close(line);
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  Simulator(const Simulator&) = delete;
  Simulator& operator=(const Simulator&) = delete;

  static void send(int fd, const sync_message& message) {
    std::uint8_t wire[SYNC_MAX_WIRE];
    const std::size_t size = frame_encode_message(&message, 0, wire);
    ASSERT_EQ(write(fd, wire, size), static_cast<ssize_t>(size));
  }

  // All that comes until the line ends.
  void listen_to_the_end() {
    std::uint8_t bytes[4096];
    for (ssize_t got; (got = read(line, bytes, sizeof bytes)) > 0;)
      for (ssize_t i = 0; i < got; ++i) take(bytes[i]);
  }
  void take(std::uint8_t byte) {
    frame_view view;
    sync_message message{};
    if (frame_receive(&receiver_, byte, &view) && frame_message(&view, &message)) messages.push_back(message);
  }

  std::vector<const sync_message*> all(std::uint8_t type) const {
    std::vector<const sync_message*> found;
    for (const auto& message : messages)
      if (message.type == type) found.push_back(&message);
    return found;
  }
  std::uint32_t damaged() const { return receiver_.damaged; }

  int line = -1;
  std::vector<sync_message> messages;

 private:
  pid_t process_ = -1;
  frame_receiver receiver_{};
};

sync_message configuration() {
  sync_message request{};
  request.type = SYNC_CONFIGURE;
  request.configuration = settings_default();
  request.configuration.trigger_on = 1;
  request.configuration.camera_on = 1;
  request.configuration.heartbeat_ms = 0;
  return request;
}

TEST(SyncSimulator, TheBoardSeesTheWorldItLivesIn) {
  Simulator board({"--stdio",
                   "--fast",
                   "--seconds",
                   "30",
                   "--drift-ppm",
                   "-50",
                   "--reference-hz",
                   "1",
                   "--reference-ppm",
                   "40",
                   "--lost-triggers",
                   "0.05",
                   "--lost-strobes",
                   "0.05",
                   "--lamp",
                   "100:0.3",
                   "--lamp",
                   "733.2:0.05",
                   "--tilt-deg",
                   "20",
                   "--camera-delay-us",
                   "120",
                   "--exposure-us",
                   "3000",
                   "--press-every",
                   "10"});
  sync_message request = configuration();
  request.configuration.reference = SYNC_REFERENCE_PULSE;
  request.configuration.exposure_ns = 6'000'000;
  Simulator::send(board.line, request);
  board.listen_to_the_end();
  EXPECT_EQ(board.damaged(), 0u);

  const auto configured = board.all(SYNC_CONFIGURATION);
  ASSERT_EQ(configured.size(), 1u);
  const auto statuses = board.all(SYNC_STATUS);
  ASSERT_GE(statuses.size(), 29u);
  const sync_status& status = statuses.back()->status;
  EXPECT_EQ(status.lock, SYNC_LOCK_LOCKED);
  // 40 ppm fast against a board 50 ppm slow; 200 ns over the filter's eight seconds.
  EXPECT_NEAR(status.frequency_ppb, 90'000, 250);
  EXPECT_LT(status.phase_rms_ns, 1000u);
  EXPECT_EQ(status.link_dropped, 0u);
  EXPECT_EQ(status.late_triggers, 0u);

  std::map<std::uint32_t, std::uint64_t> triggers;
  for (const auto* message : board.all(SYNC_TRIGGER))
    triggers[message->trigger.n] = message->trigger.t_board_ns;
  EXPECT_GT(triggers.size(), 1700u);
  std::size_t paired = 0;
  for (const auto* message : board.all(SYNC_STROBE)) {
    ASSERT_EQ(message->strobe.flags, SYNC_STROBE_PAIRED);
    ASSERT_TRUE(triggers.contains(message->strobe.n));
    // The camera's delay, and two captures of 200 ns: six sigma.
    EXPECT_NEAR(static_cast<double>(message->strobe.t_rise_board_ns - triggers[message->strobe.n]), 120'000,
                1700);
    EXPECT_NEAR(static_cast<double>(message->strobe.t_fall_board_ns - message->strobe.t_rise_board_ns),
                3'000'000, 1900);
    ++paired;
  }
  // A tenth is lost, and the camera's first half second: binomial, four sigma is 50.
  EXPECT_NEAR(static_cast<double>(paired), 0.9025 * (static_cast<double>(triggers.size()) - 30), 60);

  const auto light = board.all(SYNC_PHOTODIODE);
  ASSERT_GE(light.size(), 13u);
  const sync_photodiode& lamps = light.back()->photodiode;
  ASSERT_EQ(lamps.frequencies, 2);
  EXPECT_NEAR(lamps.frequency_mhz[0], 100'000, 100);
  EXPECT_NEAR(lamps.frequency_mhz[1], 733'200, 100);
  EXPECT_NEAR(lamps.depth_ppm[0], 300'000, 30'000);
  EXPECT_NEAR(lamps.depth_ppm[1], 50'000, 5'000);
  EXPECT_NEAR(lamps.level_mlx, 500'000, 2'000);
  EXPECT_LT(lamps.beat_ppm, 30'000u);  // 700,000 without the advice

  const auto imu = board.all(SYNC_IMU);
  ASSERT_FALSE(imu.empty());
  const auto& up = imu.back()->imu.up_um_s2;
  EXPECT_NEAR(std::atan2(up[1], up[2]) * 180 / 3.14159265, 20, 0.2);
  EXPECT_EQ(imu.back()->imu.flags, SYNC_IMU_STEADY);
  EXPECT_NEAR(board.all(SYNC_TEMPERATURE).back()->temperature.temperature_mc, 25'730,
              300);  // 30 s of ten minutes
  EXPECT_EQ(board.all(SYNC_BUTTON).size(), 2u);
}

TEST(SyncSimulator, HoldsOverWhenTheReferenceIsUnplugged) {
  Simulator board({"--stdio", "--fast", "--seconds", "20", "--reference-hz", "25", "--reference-stops", "8"});
  sync_message request = configuration();
  request.configuration.rate_numerator = 25;
  request.configuration.reference = SYNC_REFERENCE_PULSE;
  request.configuration.reference_numerator = 25;
  Simulator::send(board.line, request);
  board.listen_to_the_end();
  std::vector<int> locks;
  for (const auto* message : board.all(SYNC_STATUS))
    if (locks.empty() || locks.back() != message->status.lock) locks.push_back(message->status.lock);
  ASSERT_FALSE(locks.empty());
  if (locks.front() == SYNC_LOCK_ACQUIRING) locks.erase(locks.begin());
  EXPECT_EQ(locks, (std::vector<int>{SYNC_LOCK_LOCKED, SYNC_LOCK_HOLDOVER}));
}

TEST(SyncSimulator, SpeaksOnATerminal) {
  Simulator board({});
  std::string path;
  for (char letter = 0; read(board.line, &letter, 1) == 1 && letter != '\n';) path += letter;
  const int terminal = open(path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  ASSERT_GE(terminal, 0) << path;
  sync_message request{};
  request.type = SYNC_HELLO_REQUEST;
  Simulator::send(terminal, request);
  for (int i = 0; i < 300 && board.all(SYNC_HELLO).empty(); ++i) {
    pollfd wait{terminal, POLLIN, 0};
    poll(&wait, 1, 100);
    std::uint8_t bytes[256];
    const ssize_t got = (wait.revents & POLLIN) != 0 ? read(terminal, bytes, sizeof bytes) : 0;
    for (ssize_t k = 0; k < got; ++k) board.take(bytes[k]);
  }
  close(terminal);
  ASSERT_EQ(board.all(SYNC_HELLO).size(), 1u);
  EXPECT_EQ(board.all(SYNC_HELLO)[0]->hello.schema_hash, SYNC_SCHEMA_HASH);
}

}  // namespace
