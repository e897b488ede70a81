// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The STM32F405's real image on an emulated chip: triggers by output compare, inputs by capture, light by DMA, sensors,
// settings in flash.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "firmware/core/settings.h"
#include "tests/integration/firmware/f405_board.h"
#include "tests/integration/firmware/firmware_build.h"

namespace lightwell::test {
namespace {

constexpr double kHz = 84e6;

class F405 : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* program : {"arm-none-eabi-gcc", "cmake", "ninja"})
      if (!have(program)) GTEST_SKIP() << program << " is not installed";
    const std::string folder = built_firmware();
    ASSERT_FALSE(folder.empty());
    board = std::make_unique<F405Board>(folder);
    start();
  }
  void TearDown() override {
    if (board) {
      EXPECT_EQ(board->chip.misuses, std::vector<std::string>{});
    }
  }
  void start() {
    board->chip.run(0.05);
    ASSERT_NE(board->ask_uart(message_of(SYNC_HELLO_REQUEST), SYNC_HELLO), nullptr);
  }
  // The answer to a configuration: what rules now, or FAULT.
  sync_message configure(const sync_configuration& settings) {
    auto request = message_of(SYNC_CONFIGURE);
    request.configuration = settings;
    const auto* answer = board->ask_uart(request, SYNC_CONFIGURATION, 2);
    EXPECT_NE(answer, nullptr);
    return answer != nullptr ? *answer : sync_message{};
  }
  static sync_configuration triggering(std::uint32_t numerator, std::uint32_t denominator) {
    sync_configuration settings = settings_default();
    settings.rate_numerator = numerator;
    settings.rate_denominator = denominator;
    settings.trigger_on = 1;
    settings.heartbeat_ms = 0;
    return settings;
  }
  // Lets time pass; what the board says meanwhile is in the line's messages.
  void listen(double seconds) {
    board->uart_line.messages.clear();
    board->chip.run(seconds);
    board->listen_uart();
  }

  std::unique_ptr<F405Board> board;
};

// Exact to the tick, whenever the interrupt came: rise k at k periods from the first, falls a pulse's length later; and each
// is told with its time.
TEST_F(F405, TriggersRiseAtTheTicksThatWereCalculated) {
  for (const auto& [numerator, denominator] : {std::pair{1000u, 1u}, std::pair{60000u, 1001u}}) {
    configure(triggering(numerator, denominator));
    board->chip.run(0.05);  // those of the rate before have gone
    board->edges.output.clear();
    listen(0.5);
    const auto& edges = board->edges.output;
    ASSERT_GE(edges.size(), 40u);
    const std::size_t first = edges[0].level ? 0 : 1;
    const double period = kHz * denominator / numerator;
    std::size_t told = 0;
    for (std::size_t i = first; i + 1 < edges.size(); i += 2) {
      const double exact =
          static_cast<double>(edges[first].tick) + static_cast<double>(i - first) / 2 * period;
      ASSERT_TRUE(edges[i].level);
      ASSERT_NEAR(static_cast<double>(edges[i].tick), exact, 1.0) << i;
      ASSERT_EQ(edges[i + 1].tick - edges[i].tick, std::lround(settings_default().pulse_ns * 0.084)) << i;
    }
    // Between two rises of the line and of the messages there is the same time.
    std::vector<std::uint64_t> times;
    for (const auto& message : board->uart_line.messages)
      if (message.type == SYNC_TRIGGER) times.push_back(message.trigger.t_board_ns);
    for (std::size_t i = 1; i < times.size(); ++i, ++told)
      ASSERT_NEAR(static_cast<double>(times[i] - times[i - 1]), period / 0.084, 12);  // a tick
    EXPECT_GE(told, 20u);
    const auto* status = board->ask_uart(message_of(SYNC_STATUS_REQUEST), SYNC_STATUS);
    ASSERT_NE(status, nullptr);
    EXPECT_EQ(status->status.late_triggers, 0u);
  }
}

TEST_F(F405, AStrobeIsCapturedAtItsTicksAndPaired) {
  configure(triggering(100, 1));
  board->chip.run(0.05);
  board->edges.output.clear();
  board->uart_line.messages.clear();
  std::size_t seen = 0;
  board->chip.run(0.5, [&] {
    for (; seen < board->edges.output.size(); ++seen)
      if (board->edges.output[seen].level) {
        board->edges.edge(2, board->edges.output[seen].tick + 84'000, true);       // 1 ms later,
        board->edges.edge(2, board->edges.output[seen].tick + 84'000 * 3, false);  // for 2 ms
      }
    return false;
  });
  board->listen_uart();
  int paired = 0;
  for (const auto& strobe : board->uart_line.messages) {
    if (strobe.type != SYNC_STROBE) continue;
    EXPECT_EQ(strobe.strobe.flags, SYNC_STROBE_PAIRED);
    for (const auto& trigger : board->uart_line.messages)
      if (trigger.type == SYNC_TRIGGER && trigger.trigger.n == strobe.strobe.n) {
        EXPECT_NEAR(static_cast<double>(strobe.strobe.t_rise_board_ns - trigger.trigger.t_board_ns), 1e6, 12);
        EXPECT_NEAR(static_cast<double>(strobe.strobe.t_fall_board_ns - strobe.strobe.t_rise_board_ns), 2e6,
                    12);
        ++paired;
      }
  }
  EXPECT_GE(paired, 40);
}

TEST_F(F405, TwoEdgesThatNobodyFetchedInTimeAreCountedAsLost) {
  const auto* before = board->ask_uart(message_of(SYNC_STATUS_REQUEST), SYNC_STATUS);
  ASSERT_NE(before, nullptr);
  const std::uint32_t overruns = before->status.overruns;
  for (unsigned i = 0; i < 3; ++i)
    board->edges.edge(3, board->edges.ticks() + 8'400 + i, true);  // 12 ns apart
  board->chip.run(0.01);
  const auto* status = board->ask_uart(message_of(SYNC_STATUS_REQUEST), SYNC_STATUS);
  ASSERT_NE(status, nullptr);
  EXPECT_EQ(status->status.overruns, overruns + 1);
}

TEST_F(F405, FollowsAPulsePerSecond) {
  auto settings = triggering(50, 1);
  settings.reference = SYNC_REFERENCE_PULSE;
  configure(settings);
  // 40 ppm slow by the board's clock.
  const std::uint64_t first = board->edges.ticks() + 8'400'000;
  const std::uint64_t second = 84'003'360;
  for (unsigned i = 0; i < 6; ++i) board->edges.edge(3, first + i * second, true);
  board->chip.run(4.3);
  board->edges.output.clear();
  board->chip.run(0.9);
  int rises = 0;
  for (const auto& edge : board->edges.output) {
    if (!edge.level) continue;
    ++rises;
    const double place = static_cast<double>(edge.tick - first) / (static_cast<double>(second) / 50);
    EXPECT_NEAR((place - std::round(place)) * static_cast<double>(second) / 50, 0, 84);  // 1 µs
  }
  EXPECT_GE(rises, 40);
  const auto* status = board->ask_uart(message_of(SYNC_STATUS_REQUEST), SYNC_STATUS);
  ASSERT_NE(status, nullptr);
  EXPECT_EQ(status->status.lock, SYNC_LOCK_LOCKED);
  EXPECT_NEAR(status->status.frequency_ppb, -40'000, 100);
}

TEST_F(F405, ALampThatFlickersIsFoundThroughConverterAndDma) {
  board->light.code = [](double t) {
    return static_cast<unsigned>(std::lround(2000 * (1 + 0.25 * std::sin(2 * std::numbers::pi * 100 * t))));
  };
  listen(3);
  const auto* light = board->uart_line.find(SYNC_PHOTODIODE);
  ASSERT_NE(light, nullptr);
  const sync_photodiode& said = light->photodiode;
  ASSERT_GE(said.frequencies, 1);
  EXPECT_NEAR(said.frequency_mhz[0], 100'000, 100);  // as on the host: a tenth of a hertz
  EXPECT_NEAR(said.depth_ppm[0], 250'000, 25'000);
}

// An LSM6DSO that lies on its side, and two TMP102s, registers as in their data sheets.
TEST_F(F405, SensorsAreFoundOnceTheyAreThere) {
  listen(1.5);
  EXPECT_EQ(board->uart_line.find(SYNC_IMU), nullptr);
  auto& imu = board->i2c.devices[0x6A];
  imu[0x0F] = 0x6C;
  const auto put = [&](unsigned at, int value) {
    imu[at] = static_cast<std::uint8_t>(value);
    imu[at + 1] = static_cast<std::uint8_t>(value >> 8);
  };
  put(0x28, static_cast<int>(std::lround(1 / 0.122e-3)));  // 1 g along x
  for (const auto& [address, degrees] : {std::pair{0x48u, 25}, std::pair{0x49u, -3}}) {
    board->i2c.devices[address][0] = static_cast<std::uint8_t>(degrees);
    board->i2c.devices[address][1] = 0x80;  // and a half
  }
  listen(3);
  EXPECT_EQ(imu[0x10], 0x58);  // 208 Hz, ±4 g
  EXPECT_EQ(imu[0x11], 0x54);  // ±500 °/s
  const sync_message* last = nullptr;
  int temperatures[2] = {};
  for (const auto& message : board->uart_line.messages) {
    if (message.type == SYNC_IMU) last = &message;
    if (message.type == SYNC_TEMPERATURE)
      temperatures[message.temperature.sensor] = message.temperature.temperature_mc;
  }
  ASSERT_NE(last, nullptr);
  EXPECT_NEAR(last->imu.up_um_s2[0], 9'806'650, 2'000);  // a code is 1200 µm/s²
  EXPECT_NEAR(last->imu.up_um_s2[1], 0, 1'000);
  EXPECT_NE(last->imu.flags & SYNC_IMU_STEADY, 0);
  EXPECT_EQ(temperatures[SYNC_SENSOR_BOARD], 25'500);
  EXPECT_EQ(temperatures[SYNC_SENSOR_CAMERA], -2'500);
}

TEST_F(F405, SettingsAreInFlashAfterAReset) {
  auto settings = triggering(24000, 1001);
  settings.store = 1;
  for (int i = 0; i < 3; ++i) {  // both copies, and the first again
    settings.pulse_ns = 100'000u + 1'000u * static_cast<unsigned>(i);
    EXPECT_EQ(configure(settings).configuration.store, 1);
    board->chip.reset();
    start();
    const auto* kept = board->ask_uart(message_of(SYNC_CONFIGURATION_REQUEST), SYNC_CONFIGURATION);
    ASSERT_NE(kept, nullptr);
    EXPECT_EQ(kept->configuration.pulse_ns, settings.pulse_ns);
    EXPECT_EQ(kept->configuration.rate_numerator, 24000u);
    EXPECT_EQ(kept->configuration.store, 1);
  }
}

}  // namespace
}  // namespace lightwell::test
