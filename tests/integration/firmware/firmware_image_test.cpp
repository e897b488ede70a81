// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Builds the sync board's images and runs them in QEMU: the whole board on mps2-an386, with edges from a second UART and
// time counted in instructions; the STM32F405's as far as netduinoplus2 models one. Skips where the toolchain or QEMU is
// missing.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/integration/firmware/emulator.h"
#include "tests/integration/firmware/firmware_build.h"

namespace {

using lightwell::test::Emulator;
using lightwell::test::have;

constexpr std::uint32_t kHz = 25'000'000;  // the emulated board's clock

class FirmwareImage : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* program : {"arm-none-eabi-gcc", "qemu-system-arm", "cmake", "ninja"})
      if (!have(program)) GTEST_SKIP() << program << " is not installed";
    folder_ = lightwell::test::built_firmware();
    ASSERT_FALSE(folder_.empty());
  }
  std::string image(const char* name) const { return folder_ + "/" + name; }

  std::string folder_;
};

TEST_F(FirmwareImage, AnswersHelloAndPingOnAnEmulatedBoard) {
  Emulator emulator("mps2-an386", image("lightwell-sync-mps2.elf"), true);
  ASSERT_TRUE(emulator.connected);
  const auto hello = emulator.ask(SYNC_HELLO_REQUEST, SYNC_HELLO);
  ASSERT_TRUE(hello);
  EXPECT_EQ(hello->hello.schema_hash, SYNC_SCHEMA_HASH);
  EXPECT_EQ(hello->hello.tick_hz, kHz);
  std::uint64_t last_ns = 0;
  for (std::uint64_t i = 0; i < 50; ++i) {
    sync_message ping{};
    ping.type = SYNC_PING;
    ping.ping.t_host_ns = 0x0900000000000000ull + i;
    const auto pong = emulator.ask(ping, SYNC_PONG);
    ASSERT_TRUE(pong);
    EXPECT_EQ(pong->pong.t_host_ns, ping.ping.t_host_ns);
    EXPECT_LE(pong->pong.t_received_board_ns, pong->pong.t_sent_board_ns);
    EXPECT_LT(last_ns, pong->pong.t_received_board_ns);
    last_ns = pong->pong.t_sent_board_ns;
  }
}

// LIGHTWELL_QEMU_TRIGGERS=100000 runs the long version.
TEST_F(FirmwareImage, TriggerPeriodsAreExactToTheCycle) {
  const char* wanted = std::getenv("LIGHTWELL_QEMU_TRIGGERS");
  const std::size_t count = wanted != nullptr ? std::stoul(wanted) : 1000;
  struct Rate {
    std::uint32_t numerator, denominator;
  };
  for (const Rate rate : {Rate{1000, 1}, Rate{60000, 1001}}) {
    Emulator emulator("mps2-an386", image("lightwell-sync-mps2.elf"), true);
    ASSERT_TRUE(emulator.connected);
    ASSERT_TRUE(emulator.ask(SYNC_HELLO_REQUEST, SYNC_HELLO));
    ASSERT_TRUE(emulator.configure(rate.numerator, rate.denominator));
    const std::size_t pulses = rate.denominator == 1 ? count : 200;
    ASSERT_TRUE(emulator.run_until([&] { return emulator.pulses.size() >= pulses; }))
        << emulator.pulses.size();
    // Against the exact rate, from the first pulse that TRIGGER names. The interrupt that stamps comes a constant number
    // of instructions after its timer.
    std::uint64_t since = 0;
    for (std::size_t i = 1; i < pulses; ++i) {
      since += emulator.pulses[i] - emulator.pulses[i - 1];
      const double exact = static_cast<double>(i) * kHz * rate.denominator / rate.numerator;
      if (rate.denominator == 1) {
        ASSERT_EQ(static_cast<double>(since), exact) << i;
      } else {
        ASSERT_NEAR(static_cast<double>(since), exact, 1.0) << i;  // both ends are rounded to whole cycles
      }
    }
    const auto status = emulator.ask(SYNC_STATUS_REQUEST, SYNC_STATUS);
    ASSERT_TRUE(status);
    EXPECT_EQ(status->status.late_triggers, 0u);
  }
}

TEST_F(FirmwareImage, FollowsAReferenceAndPairsStrobes) {
  Emulator emulator("mps2-an386", image("lightwell-sync-mps2.elf"), true);
  ASSERT_TRUE(emulator.connected);
  ASSERT_TRUE(emulator.ask(SYNC_HELLO_REQUEST, SYNC_HELLO));
  ASSERT_TRUE(emulator.configure(50, 1, SYNC_REFERENCE_PULSE, 25));
  ASSERT_TRUE(emulator.run_until([&] { return emulator.pulses.size() >= 5; }));
  // 25 Hz, 100 ppm fast, for three seconds from now on.
  const std::uint32_t period = kHz / 25 - 100;
  const std::uint32_t first = emulator.pulses.back() + 333'333;
  for (std::uint32_t i = 0; i < 75; ++i) emulator.edge(BOARD_REFERENCE, first + i * period);
  const auto locked = [&] {
    for (const auto& message : emulator.messages)
      if (message.type == SYNC_TRIGGER && message.trigger.flags == SYNC_TRIGGER_LOCKED) return true;
    return false;
  };
  ASSERT_TRUE(emulator.run_until(locked));
  const std::size_t from = emulator.pulses.size() + 2;
  ASSERT_TRUE(emulator.run_until([&] { return emulator.pulses.size() >= from + 40; }));
  for (std::size_t i = from; i < from + 40; ++i) {
    const double place = static_cast<double>(emulator.pulses[i] - first) / (period / 2.0);
    // Half a microsecond: the stamp's interrupt, and rounding.
    EXPECT_NEAR((place - std::round(place)) * period / 2, 0, 12) << i;
  }

  // Strobes for the next pulses, as they come.
  emulator.messages.clear();
  std::size_t answered = emulator.pulses.size();
  const auto strobes = [&] {
    return std::count_if(emulator.messages.begin(), emulator.messages.end(),
                         [](const sync_message& message) { return message.type == SYNC_STROBE; });
  };
  ASSERT_TRUE(emulator.run_until([&] {
    // The newest only: those before may be out of the board's memory by now, so fast does its time go.
    if (answered < emulator.pulses.size()) {
      answered = emulator.pulses.size();
      emulator.edge(BOARD_STROBE_RISE, emulator.pulses.back() + 2'500);
      emulator.edge(BOARD_STROBE_FALL, emulator.pulses.back() + 52'500);
    }
    return strobes() >= 10;
  }));
  int paired = 0;
  for (const auto& strobe : emulator.messages) {
    if (strobe.type != SYNC_STROBE || strobe.strobe.flags != SYNC_STROBE_PAIRED) continue;
    for (const auto& trigger : emulator.messages) {
      if (trigger.type != SYNC_TRIGGER || trigger.trigger.n != strobe.strobe.n) continue;
      ++paired;
      EXPECT_NEAR(static_cast<double>(strobe.strobe.t_rise_board_ns - trigger.trigger.t_board_ns), 100'000,
                  500);
      EXPECT_NEAR(static_cast<double>(strobe.strobe.t_fall_board_ns - strobe.strobe.t_rise_board_ns),
                  2'000'000, 41);
    }
  }
  EXPECT_GE(paired, 3);
}

// Clocks, converter, DMA and I2C are stubs there that read 0: what is shown is that the image starts, none of its waits is
// endless, and its interrupts and serial line work.
TEST_F(FirmwareImage, TheStm32ImageStartsAndAnswers) {
  // The boot program finds image A as a programmer leaves it: with its record, where the build could sign it.
  const bool is_signed = std::filesystem::exists(image("lightwell-sync-f405-a.bin"));
  const std::string program = is_signed ? image("lightwell-sync-f405-a.bin") + ",addr=0x08010000,force-raw=on"
                                        : image("lightwell-sync-f405-a.elf");
  Emulator emulator("netduinoplus2", image("lightwell-boot-f405.elf"), false,
                    {"-device", "loader,file=" + program});
  ASSERT_TRUE(emulator.connected);
  const auto hello = emulator.ask(SYNC_HELLO_REQUEST, SYNC_HELLO);
  ASSERT_TRUE(hello);
  EXPECT_EQ(hello->hello.schema_hash, SYNC_SCHEMA_HASH);
  EXPECT_EQ(hello->hello.slot, 0);
  EXPECT_EQ((hello->hello.capabilities & SYNC_CAN_UPDATE) != 0, is_signed);
  sync_message begin{};
  begin.type = SYNC_UPDATE_BEGIN;
  const auto refused = emulator.ask(begin, SYNC_FAULT);
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->fault.code, is_signed ? SYNC_FAULT_RANGE : SYNC_FAULT_UNSUPPORTED);
}

// Flash and RAM are held to 64 and 16 KB by the linker scripts.
TEST_F(FirmwareImage, EveryFrameIsKnownAndTheDeepestStackFits) {
  for (const char* program : {"python3", "arm-none-eabi-objdump"})
    if (!have(program)) GTEST_SKIP() << program << " is not installed";
  for (const char* name :
       {"lightwell-boot-f405", "lightwell-sync-f405-a", "lightwell-sync-f405-b", "lightwell-sync-mps2"}) {
    const std::string command = LIGHTWELL_SOURCE_DIR "/scripts/firmware-stack " + folder_ + " " + name;
    EXPECT_EQ(std::system(command.c_str()), 0) << name;
    EXPECT_NE(std::system((command + " 256 >/dev/null").c_str()), 0) << "a limit that is passed must be said";
  }
}

}  // namespace
