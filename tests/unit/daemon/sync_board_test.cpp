// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/sync_board.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <deque>
#include <vector>

#include "daemon/clock.h"
#include "tests/support/eventually.h"

namespace lightwell {
namespace {

using std::chrono::milliseconds;
using test::eventually;

// A board as a test tells it to be, at the other end of a link: answers what is asked, with a clock of its own.
class ScriptedBoard {
 public:
  struct Behaviour {
    bool present = true;
    bool silent = false;
    std::uint32_t schema = SYNC_SCHEMA_HASH;
    std::uint8_t version = SYNC_PROTOCOL_VERSION;
    int lose_configures = 0;  // so many do not arrive
  };

  // What the board has sent and the host has not read.
  Result<std::size_t> read(std::span<std::uint8_t> buffer, milliseconds timeout) {
    for (auto waited = milliseconds(0);; waited += milliseconds(1)) {
      {
        const std::scoped_lock lock(mutex_);
        if (!behaviour_.present) return Error{ErrorKind::failed, "the board hung up"};
        const std::size_t size = std::min(buffer.size(), to_host_.size());
        for (std::size_t i = 0; i < size; ++i) buffer[i] = to_host_[i];
        to_host_.erase(to_host_.begin(), to_host_.begin() + static_cast<std::ptrdiff_t>(size));
        if (size > 0 || waited >= timeout) return size;
      }
      std::this_thread::sleep_for(milliseconds(1));
    }
  }
  Status write(std::span<const std::uint8_t> bytes) {
    const std::scoped_lock lock(mutex_);
    if (!behaviour_.present) return Error{ErrorKind::failed, "the board hung up"};
    for (const std::uint8_t byte : bytes) {
      frame_view frame{};
      sync_message message{};
      if (frame_receive(&receiver_, byte, &frame) && frame_message(&frame, &message)) answer(message);
    }
    return {};
  }
  Result<std::unique_ptr<SyncLink>> open();

  void behave(const Behaviour& behaviour) {
    const std::scoped_lock lock(mutex_);
    behaviour_ = behaviour;
    to_host_.clear();
    start_ns_ = mono_now_ns();
    configuration_ = {};
    configuration_.rate_numerator = 60;
    configuration_.rate_denominator = 1;
  }
  void say(const sync_message& message) {
    const std::scoped_lock lock(mutex_);
    send(message);
  }
  void say_garbage(const std::vector<std::uint8_t>& bytes) {
    const std::scoped_lock lock(mutex_);
    to_host_.insert(to_host_.end(), bytes.begin(), bytes.end());
  }
  std::uint64_t board_ns(std::int64_t mono_ns) const {
    return static_cast<std::uint64_t>(mono_ns - start_ns_);
  }
  sync_configuration configuration() {
    const std::scoped_lock lock(mutex_);
    return configuration_;
  }
  int configures() {
    const std::scoped_lock lock(mutex_);
    return configures_;
  }
  std::uint8_t host_state() {
    const std::scoped_lock lock(mutex_);
    return host_state_;
  }

 private:
  void send(const sync_message& message) {
    std::array<std::uint8_t, SYNC_MAX_WIRE> wire{};
    std::size_t size = frame_encode_message(&message, sequence_++, wire.data());
    if (behaviour_.version != SYNC_PROTOCOL_VERSION) {
      std::array<std::uint8_t, SYNC_MAX_PAYLOAD> payload{};
      const std::size_t payload_size = sync_pack(&message, payload.data());
      size = other_version(message.type, {payload.data(), payload_size}, wire.data());
    }
    to_host_.insert(to_host_.end(), wire.begin(), wire.begin() + static_cast<std::ptrdiff_t>(size));
  }
  // As a board of another age would send it: COBS by hand, for frames below 254 bytes.
  std::size_t other_version(std::uint8_t type, std::span<const std::uint8_t> payload,
                            std::uint8_t* wire) const {
    std::vector<std::uint8_t> frame = {behaviour_.version, type, 0, 0};
    frame.insert(frame.end(), payload.begin(), payload.end());
    const std::uint16_t crc = frame_crc16(frame.data(), frame.size());
    frame.push_back(static_cast<std::uint8_t>(crc & 0xff));
    frame.push_back(static_cast<std::uint8_t>(crc >> 8));
    std::size_t out = 1, code = 0;
    std::uint8_t run = 1;
    for (const std::uint8_t byte : frame) {
      if (byte == 0) {
        wire[code] = run;
        code = out++;
        run = 1;
      } else {
        wire[out++] = byte;
        ++run;
      }
    }
    wire[code] = run;
    wire[out++] = 0;
    return out;
  }
  void answer(const sync_message& message) {
    if (behaviour_.silent) return;
    sync_message reply{};
    switch (message.type) {
      case SYNC_HELLO_REQUEST:
        reply.type = SYNC_HELLO;
        reply.hello.schema_hash = behaviour_.schema;
        reply.hello.version[0] = 1;
        break;
      case SYNC_PING:
        reply.type = SYNC_PONG;
        reply.pong = {message.ping.t_host_ns, board_ns(mono_now_ns()), board_ns(mono_now_ns())};
        break;
      case SYNC_CONFIGURE:
        ++configures_;
        if (behaviour_.lose_configures > 0) {
          --behaviour_.lose_configures;
          return;
        }
        if (message.configuration.rate_numerator > 1000 * message.configuration.rate_denominator) {
          reply.type = SYNC_FAULT;
          reply.fault = {SYNC_FAULT_RANGE, SYNC_CONFIGURE, 0, 1, 1000};
          break;
        }
        configuration_ = message.configuration;
        [[fallthrough]];
      case SYNC_CONFIGURATION_REQUEST:
        reply.type = SYNC_CONFIGURATION;
        reply.configuration = configuration_;
        break;
      case SYNC_HOST_STATE:
        host_state_ = message.host_state.state;
        return;
      default:
        return;
    }
    send(reply);
  }

  std::mutex mutex_;
  Behaviour behaviour_;
  std::deque<std::uint8_t> to_host_;
  frame_receiver receiver_{};
  std::uint16_t sequence_ = 0;
  std::int64_t start_ns_ = mono_now_ns();
  sync_configuration configuration_{};
  std::uint8_t host_state_ = 255;
  int configures_ = 0;
};

class ScriptedLink final : public SyncLink {
 public:
  explicit ScriptedLink(ScriptedBoard& board) : board_(board) {}
  Result<std::size_t> read(std::span<std::uint8_t> buffer, milliseconds timeout) override {
    return board_.read(buffer, timeout);
  }
  Status write(std::span<const std::uint8_t> bytes) override { return board_.write(bytes); }

 private:
  ScriptedBoard& board_;
};

Result<std::unique_ptr<SyncLink>> ScriptedBoard::open() {
  const std::scoped_lock lock(mutex_);
  if (!behaviour_.present) return Error{ErrorKind::failed, "no sync board on USB"};
  frame_receiver_init(&receiver_);
  return std::unique_ptr<SyncLink>(std::make_unique<ScriptedLink>(*this));
}

class SyncBoards : public ::testing::Test {
 protected:
  BoardOptions options() {
    BoardOptions options;
    options.open = [this] { return there_.open(); };
    return options;
  }
  static bool connected(const SyncBoard& board) { return board.view().state == BoardState::connected; }

  ScriptedBoard there_;
  StrobeRing strobes_;
  TimecodeStamper timecodes_;
};

TEST_F(SyncBoards, WhatTheBoardSaysIsSeen) {
  SyncBoard board(options(), strobes_, timecodes_);
  ASSERT_TRUE(eventually([&] { return connected(board) && board.view().clock_bound_us > 0; }));
  sync_message status{}, imu{}, temperature{}, lamp{};
  status.type = SYNC_STATUS;
  status.status.lock = SYNC_LOCK_LOCKED;
  imu.type = SYNC_IMU;
  imu.imu.up_um_s2[1] = 9'810'000;
  temperature.type = SYNC_TEMPERATURE;
  temperature.temperature = {0, SYNC_SENSOR_CAMERA, 41'500};
  lamp.type = SYNC_PHOTODIODE;
  lamp.photodiode.frequencies = 1;
  lamp.photodiode.frequency_mhz[0] = 100'000;
  for (const sync_message& message : {status, imu, temperature, lamp}) there_.say(message);
  ASSERT_TRUE(eventually([&] { return board.view().photodiode.has_value(); }));
  const BoardView view = board.view();
  EXPECT_EQ(view.status->lock, SYNC_LOCK_LOCKED);
  EXPECT_EQ(view.imu->up_um_s2[1], 9'810'000);
  EXPECT_EQ(view.temperature[SYNC_SENSOR_CAMERA]->temperature_mc, 41'500);
  EXPECT_FALSE(view.temperature[SYNC_SENSOR_BOARD]);
  EXPECT_EQ(view.photodiode->frequency_mhz[0], 100'000u);
  EXPECT_EQ(view.lost_frames, 0u);
}

TEST_F(SyncBoards, StrobesComeByTheHostsClock) {
  SyncBoard board(options(), strobes_, timecodes_);
  ASSERT_TRUE(eventually([&] { return connected(board) && board.view().clock_bound_us > 0; }));
  const std::int64_t begin = mono_now_ns(), end = begin + 4'000'000;
  sync_message strobe{};
  strobe.type = SYNC_STROBE;
  strobe.strobe = {7, there_.board_ns(begin), there_.board_ns(end), SYNC_STROBE_PAIRED};
  sync_message stray = strobe, open_end = strobe;
  stray.strobe.flags = 0;
  stray.strobe.n = 8;
  open_end.strobe.flags = SYNC_STROBE_PAIRED | SYNC_STROBE_NO_FALL;
  open_end.strobe.n = 9;
  for (const sync_message& message : {strobe, stray, open_end}) there_.say(message);
  ASSERT_TRUE(eventually([&] { return !strobes_.empty(); }));
  const auto exposure = strobes_.newest_before(end + 2'000'000'000);
  ASSERT_TRUE(exposure);
  EXPECT_EQ(exposure->trigger, 7u);
  EXPECT_NEAR(static_cast<double>(exposure->begin_mono_ns - begin), 0,
              1e3 * board.view().clock_bound_us + 1e3);
  EXPECT_NEAR(static_cast<double>(exposure->end_mono_ns - exposure->begin_mono_ns), 4e6, 1e4);
}

TEST_F(SyncBoards, TheConfiguredTriggerIsSentWithWhatTheBoardHas) {
  BoardOptions with = options();
  with.trigger = BoardOptions::Trigger{};
  with.trigger->rate_numerator = 24;
  there_.behave({});
  SyncBoard board(with, strobes_, timecodes_);
  ASSERT_TRUE(eventually([&] { return there_.configuration().trigger_on == 1; }));
  EXPECT_EQ(there_.configuration().rate_numerator, 24u);
  EXPECT_EQ(there_.configuration().store, 0) << "flash wears";
  std::this_thread::sleep_for(milliseconds(300));  // so that its time goes back when it starts anew
  // The board forgets all of it when it starts anew, and is told again.
  there_.behave({});
  EXPECT_TRUE(eventually([&] { return there_.configuration().trigger_on == 1; }));
  EXPECT_TRUE(eventually([&] { return board.view().reconnects >= 1; }));
}

TEST_F(SyncBoards, ALostConfigurationIsSaidAgainUntilTheBoardHasIt) {
  BoardOptions with = options();
  with.trigger = BoardOptions::Trigger{};
  with.trigger->rate_numerator = 24;
  ScriptedBoard::Behaviour lossy;
  lossy.lose_configures = 2;
  there_.behave(lossy);
  SyncBoard board(with, strobes_, timecodes_);
  ASSERT_TRUE(eventually([&] { return there_.configuration().trigger_on == 1; }));
  EXPECT_EQ(there_.configuration().rate_numerator, 24u);
  std::this_thread::sleep_for(milliseconds(1200));
  EXPECT_EQ(there_.configures(), 3) << "and no more once it has it";
}

// The firmware stops triggers when it has heard nothing for its heartbeat: a daemon that was stopped, a machine that slept.
TEST_F(SyncBoards, ABoardThatWentBackToSafeDefaultsIsConfiguredAnew) {
  BoardOptions with = options();
  with.trigger = BoardOptions::Trigger{};
  there_.behave({});
  SyncBoard board(with, strobes_, timecodes_);
  ASSERT_TRUE(eventually([&] { return there_.configuration().trigger_on == 1; }));
  const int before = there_.configures();
  sync_message status{};
  status.type = SYNC_STATUS;
  status.status.safe = 1;
  there_.say(status);
  EXPECT_TRUE(eventually([&] { return there_.configures() > before; }));
}

TEST_F(SyncBoards, AnotherTriggerIsToldAndARefusedOneIsNotRepeated) {
  BoardOptions with = options();
  with.trigger = BoardOptions::Trigger{};
  there_.behave({});
  SyncBoard board(with, strobes_, timecodes_);
  ASSERT_TRUE(eventually([&] { return there_.configuration().trigger_on == 1; }));
  board.set_trigger(24.5, 9000);
  ASSERT_TRUE(eventually([&] { return there_.configuration().rate_numerator == 24'500; }));
  EXPECT_EQ(there_.configuration().rate_denominator, 1000u);
  EXPECT_EQ(there_.configuration().exposure_ns, 9'000'000u);
  board.set_trigger(25, 8000);
  ASSERT_TRUE(eventually([&] { return there_.configuration().rate_numerator == 25; }))
      << "the exact one again";
  EXPECT_EQ(there_.configuration().rate_denominator, 1u);
}

TEST_F(SyncBoards, WhatItRefusesIsSaidByFieldAndRange) {
  BoardOptions with = options();
  with.trigger = BoardOptions::Trigger{};
  with.trigger->rate_numerator = 5000;
  SyncBoard board(with, strobes_, timecodes_);
  ASSERT_TRUE(eventually([&] { return !board.view().refused.empty(); }));
  EXPECT_NE(board.view().refused.find("rate_numerator: allowed 1 to 1000"), std::string::npos)
      << board.view().refused;
  std::this_thread::sleep_for(milliseconds(1200));
  EXPECT_EQ(there_.configures(), 1) << "it would be refused again";
}

TEST_F(SyncBoards, ABoardThatGoesIsFoundAgainWithinTwoSeconds) {
  SyncBoard board(options(), strobes_, timecodes_);
  ASSERT_TRUE(eventually([&] { return connected(board); }));
  there_.behave({false});
  ASSERT_TRUE(eventually([&] { return board.view().state == BoardState::no_device; }));
  EXPECT_FALSE(board.view().hello) << "nothing of the board that is gone is told";
  there_.behave({});
  EXPECT_TRUE(eventually([&] { return connected(board); }, std::chrono::seconds(2)));
  EXPECT_EQ(board.view().reconnects, 1u);
}

TEST_F(SyncBoards, ASilentBoardIsNotTakenForOneThatIsWell) {
  SyncBoard board(options(), strobes_, timecodes_);
  ASSERT_TRUE(eventually([&] { return connected(board); }));
  there_.behave({true, true});
  ASSERT_TRUE(eventually([&] { return board.view().state == BoardState::no_device; }));
  EXPECT_NE(board.view().description.find("silent"), std::string::npos);
}

TEST_F(SyncBoards, OtherFirmwareIsNamedAndNotSpokenTo) {
  there_.behave({true, false, 0x12345678});
  BoardOptions with = options();
  with.trigger = BoardOptions::Trigger{};
  SyncBoard board(with, strobes_, timecodes_);
  ASSERT_TRUE(eventually([&] { return board.view().state == BoardState::wrong_firmware; }));
  EXPECT_NE(board.view().description.find("12345678"), std::string::npos) << board.view().description;
  EXPECT_EQ(there_.configuration().trigger_on, 0);
  there_.behave({true, false, SYNC_SCHEMA_HASH, 1});
  ASSERT_TRUE(eventually([&] { return board.view().description.find("version 1 ") != std::string::npos; }))
      << board.view().description;
}

TEST_F(SyncBoards, OtherFirmwareThatIsUnpluggedIsNoDevice) {
  there_.behave({true, false, 0x12345678});
  SyncBoard board(options(), strobes_, timecodes_);
  ASSERT_TRUE(eventually([&] { return board.view().state == BoardState::wrong_firmware; }));
  there_.behave({false});
  EXPECT_TRUE(eventually([&] { return board.view().state == BoardState::no_device; }))
      << board.view().description;
}

TEST_F(SyncBoards, GarbageAndLostFramesAreSurvivedAndCounted) {
  SyncBoard board(options(), strobes_, timecodes_);
  ASSERT_TRUE(eventually([&] { return connected(board); }));
  there_.say_garbage(std::vector<std::uint8_t>(5000, 0x55));
  there_.say_garbage({0});
  sync_message imu{};
  imu.type = SYNC_IMU;
  imu.imu.up_um_s2[0] = 5;
  there_.say(imu);
  ASSERT_TRUE(eventually([&] { return board.view().imu.has_value(); }));
  EXPECT_EQ(board.view().imu->up_um_s2[0], 5);
  EXPECT_TRUE(connected(board));
}

TEST_F(SyncBoards, TheLedAndTheButtonReachTheOtherSide) {
  std::atomic<int> presses{0};
  BoardOptions with = options();
  with.on_button = [&](sync_press press) { presses += press == SYNC_BUTTON_SHORT ? 1 : 100; };
  SyncBoard board(with, strobes_, timecodes_);
  ASSERT_TRUE(eventually([&] { return connected(board); }));
  board.set_host_state(SYNC_HOST_RECORDING);
  EXPECT_TRUE(eventually([&] { return there_.host_state() == SYNC_HOST_RECORDING; }));
  sync_message press{};
  press.type = SYNC_BUTTON;
  press.button = {0, SYNC_BUTTON_SHORT};
  there_.say(press);
  EXPECT_TRUE(eventually([&] { return presses == 1; }));
}

TEST(SyncAddresses, AreUsbOrSerialAndNothingElse) {
  EXPECT_EQ(parse_sync_address("usb")->kind, SyncAddress::Kind::usb);
  EXPECT_EQ(parse_sync_address("usb:4711")->place, "4711");
  EXPECT_EQ(parse_sync_address("serial:/dev/ttyACM0")->place, "/dev/ttyACM0");
  for (const char* wrong : {"", "usb:", "serial:", "serial", "/dev/ttyACM0", "USB"}) {
    const auto address = parse_sync_address(wrong);
    ASSERT_FALSE(address) << wrong;
    EXPECT_EQ(address.error().kind, ErrorKind::usage);
    EXPECT_NE(address.error().message.find("usb:SERIAL"), std::string::npos);
  }
}

// A pseudo-terminal is a serial device whose other end is ours.
TEST(SerialLinks, CarryBytesBothWaysAndSayWhenTheBoardHangsUp) {
  const int other_end = posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_GE(other_end, 0);
  ASSERT_EQ(grantpt(other_end), 0);
  ASSERT_EQ(unlockpt(other_end), 0);
  const std::string path = ptsname(other_end);
  auto link = open_serial_link(path);
  ASSERT_TRUE(link) << link.error().message;
  EXPECT_FALSE(open_serial_link(path)) << "one program at a time";
  std::vector<std::uint8_t> all(256);
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i] = static_cast<std::uint8_t>(i);  // XON, newline, 0 among them
  ASSERT_TRUE((*link)->write(all));
  std::vector<std::uint8_t> there(256);
  std::size_t got = 0;
  while (got < there.size()) {
    const ssize_t size = read(other_end, there.data() + got, there.size() - got);
    ASSERT_GT(size, 0);
    got += static_cast<std::size_t>(size);
  }
  EXPECT_EQ(there, all);
  ASSERT_EQ(write(other_end, all.data(), all.size()), 256);
  std::vector<std::uint8_t> here;
  std::array<std::uint8_t, 100> part{};
  while (here.size() < all.size()) {
    const auto size = (*link)->read(part, milliseconds(1000));
    ASSERT_TRUE(size && *size > 0);
    here.insert(here.end(), part.begin(), part.begin() + static_cast<std::ptrdiff_t>(*size));
  }
  EXPECT_EQ(here, all);
  EXPECT_EQ(*(*link)->read(part, milliseconds(1)), 0u);
  close(other_end);
  const auto gone = (*link)->read(part, milliseconds(1000));
  ASSERT_FALSE(gone);
  EXPECT_NE(gone.error().message.find(path), std::string::npos) << gone.error().message;
}

TEST(SerialLinks, SayWhatIsNoSerialDevice) {
  const auto missing = open_serial_link("/dev/no-such-board");
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message.find("/dev/no-such-board: No such file"), std::string::npos);
  const auto file = open_serial_link("/dev/null");
  ASSERT_FALSE(file);
  EXPECT_NE(file.error().message.find("is no serial device"), std::string::npos) << file.error().message;
}

}  // namespace
}  // namespace lightwell
