// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The whole board as an ARM image in QEMU, with a world around it: lamps, gravity, a button, PPS, timecode, resets.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/integration/firmware/emulator.h"
#include "tests/integration/firmware/firmware_build.h"
#include "tests/support/ltc_signal.h"

namespace lightwell::test {
namespace {

constexpr std::uint32_t kHz = 25'000'000;  // the emulated board's clock

class WholeBoard : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* program : {"arm-none-eabi-gcc", "qemu-system-arm", "cmake", "ninja"})
      if (!have(program)) GTEST_SKIP() << program << " is not installed";
    const std::string folder = built_firmware();
    ASSERT_FALSE(folder.empty());
    board = std::make_unique<Emulator>("mps2-an386", folder + "/lightwell-sync-mps2.elf", true);
    ASSERT_TRUE(board->connected);
    ASSERT_TRUE(board->ask(SYNC_HELLO_REQUEST, SYNC_HELLO));
  }
  // The newest message of that type, waited for.
  const sync_message* wait_for(std::uint8_t type) {
    const sync_message* found = nullptr;
    board->run_until([&] {
      const auto at = std::find_if(board->messages.rbegin(), board->messages.rend(),
                                   [&](const sync_message& message) { return message.type == type; });
      if (at != board->messages.rend()) found = &*at;
      return found != nullptr;
    });
    return found;
  }
  // Triggers that follow the reference, without being on their way to it.
  bool locks() {
    return board->run_until([&] {
      return std::any_of(board->messages.begin(), board->messages.end(), [](const sync_message& message) {
        return message.type == SYNC_TRIGGER && message.trigger.flags == SYNC_TRIGGER_LOCKED;
      });
    });
  }
  // How far the pulses from the third after now on lie from the nearest multiple of period after first, at most; ticks.
  double distance(double first, double period) {
    const std::size_t from = board->pulses.size() + 2;
    if (!board->run_until([&] { return board->pulses.size() >= from + 40; })) return period;
    double most = 0;
    for (std::size_t i = from; i < from + 40; ++i) {
      const double place = static_cast<double>(static_cast<std::int32_t>(
                               board->pulses[i] - static_cast<std::uint32_t>(std::lround(first)))) /
                           period;
      most = std::max(most, std::abs(place - std::round(place)) * period);
    }
    return most;
  }

  std::unique_ptr<Emulator> board;
};

TEST_F(WholeBoard, FindsALampAmongItsSamples) {
  for (int i = 0; i < 17'000; ++i)
    board->stimulate('S', 0,
                     static_cast<std::uint32_t>(
                         std::lround(1500 * (1 + 0.3 * std::sin(2 * std::numbers::pi * 120 * i / 8000)))));
  const auto* light = wait_for(SYNC_PHOTODIODE);
  ASSERT_NE(light, nullptr);
  ASSERT_GE(light->photodiode.frequencies, 1);
  EXPECT_NEAR(light->photodiode.frequency_mhz[0], 120'000, 100);  // as on the host
  EXPECT_NEAR(light->photodiode.depth_ppm[0], 300'000, 30'000);
}

TEST_F(WholeBoard, KnowsWhichWayIsUpAndThatItsButtonIsHeld) {
  const float sample[6] = {0, 9.80665f, 0, 0, 0, 0};
  const sync_message* said = nullptr;
  for (int turn = 0; turn < 200 && (said == nullptr || (said->imu.flags & SYNC_IMU_STEADY) == 0); ++turn) {
    board->messages.clear();
    for (int n = 0; n < 8; ++n)
      for (unsigned i = 0; i < 6; ++i) board->stimulate('I', i, std::bit_cast<std::uint32_t>(sample[i]));
    said = wait_for(SYNC_IMU);
    ASSERT_NE(said, nullptr);
  }
  EXPECT_NE(said->imu.flags & SYNC_IMU_STEADY, 0);
  EXPECT_NEAR(said->imu.up_um_s2[0], 0, 1'000);
  EXPECT_NEAR(said->imu.up_um_s2[1], 9'806'650, 1'000);
  EXPECT_NEAR(said->imu.up_um_s2[2], 0, 1'000);

  board->stimulate('B', 0, 1);
  const auto* pressed = wait_for(SYNC_BUTTON);
  ASSERT_NE(pressed, nullptr);
  EXPECT_EQ(pressed->button.press, SYNC_BUTTON_LONG);
}

TEST_F(WholeBoard, FollowsAPulsePerSecond) {
  ASSERT_TRUE(board->configure(50, 1, SYNC_REFERENCE_PULSE, 1));
  ASSERT_TRUE(board->run_until([&] { return board->pulses.size() >= 5; }));
  const std::uint32_t second = kHz + 500;  // 20 ppm slow
  const std::uint32_t first = board->pulses.back() + 1'234'567;
  for (std::uint32_t i = 0; i < 8; ++i) board->edge(BOARD_REFERENCE, first + i * second);
  ASSERT_TRUE(locks());
  EXPECT_LE(distance(first, second / 50.0), 12);  // half a microsecond: the stamp's interrupt, and rounding
  const auto status = board->ask(SYNC_STATUS_REQUEST, SYNC_STATUS);
  ASSERT_TRUE(status);
  EXPECT_NEAR(status->status.frequency_ppb, -20'000, 100);
}

// From the line's edges to the triggers: libltc's timecode at 25 frames a second, 30 ppm fast; two triggers a frame, one of them
// at the frame's start.
TEST_F(WholeBoard, ReadsTimecodeAndTriggersWithItsFrames) {
  ASSERT_TRUE(board->configure(50, 1, SYNC_REFERENCE_TIMECODE, 25));
  ASSERT_TRUE(board->run_until([&] { return board->pulses.size() >= 5; }));
  SMPTETimecode start{};
  start.hours = 10;
  start.mins = 59;
  start.secs = 58;
  constexpr double kFast = 1 + 30e-6;
  const LtcSignal signal = encode_ltc(25, start, 100, kFast);
  // As half cells, 160 a frame: so many edges one by one would not keep up with the emulated board's time.
  const double cell = kHz / (25 * 160 * kFast);
  std::vector<bool> changes(160 * signal.starts.size());
  for (const double edge : signal.edges)
    changes.at(static_cast<std::size_t>(std::lround((edge - signal.starts[0]) * kHz / cell))) = true;
  const std::uint32_t first = board->pulses.back() + 333'333;
  board->stimulate('C', 0, first);
  board->stimulate('H', 0, static_cast<std::uint32_t>(std::lround(cell * 65536)));
  for (std::size_t at = 0; at < changes.size(); at += 32) {
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < 32; ++i) bits |= std::uint32_t{changes[at + i]} << i;
    board->stimulate('L', 32, bits);
  }
  const auto words = [&] {
    return std::count_if(board->messages.begin(), board->messages.end(),
                         [](const sync_message& message) { return message.type == SYNC_TIMECODE; });
  };
  ASSERT_TRUE(locks());
  ASSERT_TRUE(board->run_until([&] { return words() >= 90; }));
  EXPECT_LE(distance(first, kHz / 50.0 / kFast), 25);  // a microsecond: the stamp's interrupt, and rounding
  std::size_t at = 0;
  for (const auto& message : board->messages) {
    if (message.type != SYNC_TIMECODE) continue;
    const auto& said = message.timecode;
    while (at < signal.codes.size() &&
           (signal.codes[at].frame != said.frames || signal.codes[at].secs != said.seconds))
      ++at;
    ASSERT_LT(at, signal.codes.size());
    EXPECT_EQ(said.minutes, signal.codes[at].mins);
    EXPECT_EQ(said.hours, signal.codes[at].hours);
    EXPECT_EQ(said.user_bits, 0x12345678u);
  }
  const auto status = board->ask(SYNC_STATUS_REQUEST, SYNC_STATUS);
  ASSERT_TRUE(status);
  EXPECT_NEAR(status->status.frequency_ppb, 30'000, 300);
}

TEST_F(WholeBoard, SettingsOutliveResetsAtAnyMoment) {
  const auto stored = [&](std::uint32_t pulse_ns) {
    auto request = sync_message{};
    request.type = SYNC_CONFIGURE;
    request.configuration = settings_default();
    request.configuration.heartbeat_ms = 0;
    request.configuration.pulse_ns = pulse_ns;
    request.configuration.store = 1;
    return request;
  };
  const auto kept = [&]() -> std::uint32_t {
    board->messages.clear();
    const auto answer = board->ask(SYNC_CONFIGURATION_REQUEST, SYNC_CONFIGURATION);
    EXPECT_TRUE(answer && answer->configuration.store == 1);
    return answer ? answer->configuration.pulse_ns : 0;
  };
  ASSERT_TRUE(board->ask(stored(100'000), SYNC_CONFIGURATION));
  board->reset();
  ASSERT_EQ(kept(), 100'000u);
  std::uint32_t now = 100'000;
  for (std::uint32_t i = 1; i <= 10; ++i) {
    const std::uint32_t next = 100'000 + 1'000 * i;
    board->send(stored(next));
    board->reset();  // before, amidst or after
    const std::uint32_t found = kept();
    ASSERT_TRUE(found == now || found == next) << found;
    now = found;
  }
}

}  // namespace
}  // namespace lightwell::test
