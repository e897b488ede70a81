// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// New firmware on the emulated chip: the real boot program and the real images, signed by the build's own key, over USB.

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <string>

#include "firmware/core/update.h"
#include "interface/firmware_file.h"
#include "tests/integration/firmware/f405_board.h"
#include "tests/integration/firmware/firmware_build.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::test {
namespace {

class F405Update : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* program : {"arm-none-eabi-gcc", "cmake", "ninja"})
      if (!have(program)) GTEST_SKIP() << program << " is not installed";
    folder = built_firmware();
    ASSERT_FALSE(folder.empty());
    const auto file = read_firmware_file(folder + "/lightwell-sync-f405.json");
    if (!file) GTEST_SKIP() << "built without Monocypher, which could not be fetched";
    release = *file;
    board = std::make_unique<F405Board>(folder);
    if (!board->chip.has_symbol("tud_task"))
      GTEST_SKIP() << "built without TinyUSB, which could not be fetched";
  }
  void TearDown() override {
    if (board) {
      EXPECT_EQ(board->chip.misuses, std::vector<std::string>{});
    }
  }

  // The slot that runs after a start; 2: none answers.
  unsigned starts() {
    if (!board->chip.run(8, [&] { return board->usb.attached(); }) || !board->host.enumerate()) return 2;
    board->usb_line = FrameLine();
    const auto* hello = board->ask_usb(message_of(SYNC_HELLO_REQUEST), SYNC_HELLO);
    if (hello == nullptr) return 2;
    EXPECT_NE(hello->hello.capabilities & SYNC_CAN_UPDATE, 0u);
    EXPECT_TRUE(std::equal(release.version.begin(), release.version.end(), hello->hello.version));
    return hello->hello.slot;
  }
  unsigned starts_anew() {
    board->chip.reset();
    return starts();
  }

  // The host's side; 0, or the first fault's code. Ends early, with 255, where the board has started anew.
  unsigned install(const FirmwareImage& image) {
    const std::uint64_t resets = board->chip.resets;
    const auto step = [&](const sync_message& request) -> unsigned {
      board->usb_line.messages.clear();
      board->host.write(1, board->usb_line.frame(request));
      for (int i = 0; i < 40 && board->chip.resets == resets; ++i) {
        board->usb_line.take(board->host.read(1));
        if (const auto* fault = board->usb_line.find(SYNC_FAULT)) return fault->fault.code;
        if (board->usb_line.find(SYNC_UPDATE_STATE) != nullptr) return 0;
      }
      return 255;
    };
    auto begin = message_of(SYNC_UPDATE_BEGIN);
    begin.update_begin.size = static_cast<std::uint32_t>(image.bytes.size());
    std::copy(release.version.begin(), release.version.end(), begin.update_begin.version);
    if (const unsigned fault = step(begin)) return fault;
    for (std::size_t at = 0; at < image.bytes.size(); at += SYNC_UPDATE_BLOCK_BYTES) {
      auto block = message_of(SYNC_UPDATE_BLOCK);
      block.update_block.offset = static_cast<std::uint32_t>(at);
      for (std::size_t i = 0; i < SYNC_UPDATE_BLOCK_BYTES; ++i)
        block.update_block.bytes[i] = at + i < image.bytes.size() ? image.bytes[at + i] : std::uint8_t{0xFF};
      if (const unsigned fault = step(block)) return fault;
    }
    auto finish = message_of(SYNC_UPDATE_FINISH);
    std::copy(image.signature.begin(), image.signature.end(), finish.update_finish.signature);
    return step(finish);
  }
  const FirmwareImage& image(unsigned slot) const { return release.images.at(slot); }

  std::string folder;
  FirmwareFile release;
  std::unique_ptr<F405Board> board;
};

TEST_F(F405Update, AReleaseRunsIsConfirmedAndStays) {
  ASSERT_EQ(starts(), 0u);
  ASSERT_EQ(install(image(1)), 0u);
  ASSERT_EQ(starts_anew(), 1u);
  // Ten seconds with a host: it works.
  for (int i = 0; i < 22; ++i) {
    board->chip.run(0.5);
    ASSERT_NE(board->ask_usb(message_of(SYNC_STATUS_REQUEST), SYNC_STATUS), nullptr);
  }
  EXPECT_EQ(starts_anew(), 1u);
  // And back, into the slot that ran before.
  ASSERT_EQ(install(image(0)), 0u);
  EXPECT_EQ(starts_anew(), 0u);
}

TEST_F(F405Update, AnImageThatNobodyConfirmedIsLeftAtTheNextStart) {
  ASSERT_EQ(starts(), 0u);
  ASSERT_EQ(install(image(1)), 0u);
  EXPECT_EQ(starts_anew(), 1u);
  EXPECT_EQ(starts_anew(), 0u);
}

TEST_F(F405Update, WhatIsNotSignedNeverRuns) {
  ASSERT_EQ(starts(), 0u);
  FirmwareImage forged = image(1);
  forged.bytes[forged.bytes.size() / 2] ^= 1;
  EXPECT_EQ(install(forged), unsigned{SYNC_FAULT_SIGNATURE});
  EXPECT_EQ(starts_anew(), 0u);
  // The other slot's signature, over an image that would run there.
  forged = image(1);
  forged.signature = image(0).signature;
  EXPECT_EQ(install(forged), unsigned{SYNC_FAULT_SIGNATURE});
  EXPECT_EQ(starts_anew(), 0u);
  // Flash that changes after the update was accepted.
  ASSERT_EQ(install(image(1)), 0u);
  const std::uint32_t word = Stm32F405Flash::sector_start(5) + 0x4000;
  board->chip.store(word, board->chip.load(word) ^ 0x10000u);
  EXPECT_EQ(starts_anew(), 0u);
  // And where neither is whole none runs: the LED is lit, the watchdog tries again.
  const std::uint32_t other = Stm32F405Flash::sector_start(4) + 0x4000;
  board->chip.store(other, board->chip.load(other) ^ 1u);
  EXPECT_EQ(starts_anew(), 2u);
  EXPECT_EQ(board->gpio[1].output >> 12 & 1u, 1u);
  EXPECT_GE(board->chip.resets, 1u);
  board->chip.store(other, board->chip.load(other) ^ 1u);
  EXPECT_EQ(starts(), 0u);
}

// Signed by us, and no good: it does nothing at all.
TEST_F(F405Update, AnImageThatHangsGivesWayToTheOtherByTheWatchdog) {
  const TemporaryFolder work;
  const std::string source = (work.path() / "hang.c").string(), elf = (work.path() / "hang.elf").string(),
                    file = (work.path() / "hang.json").string();
  std::ofstream(source)
      << "void hang(void); void hang(void) { for (;;) {} }\n"
         "__attribute__((section(\".vectors\"), used)) static void (*const vectors[])(void) = "
         "{(void (*)(void))0x20001000, hang};\n";
  ASSERT_EQ(std::system(("arm-none-eabi-gcc -mcpu=cortex-m4 -mthumb -Os -nostdlib -Wl,-e,hang "
                         "-Wl,--section-start=.vectors=0x08020000 -Wl,-Ttext=0x08020200 " +
                         source + " -o " + elf)
                            .c_str()),
            0);
  ASSERT_EQ(std::system((std::string(LIGHTWELL_SOURCE_DIR "/scripts/firmware-sign sign ") + folder +
                         "/test-key.pem " + std::to_string(release.version[0]) + "." +
                         std::to_string(release.version[1]) + "." + std::to_string(release.version[2]) + " " +
                         folder + "/lightwell-sync-f405-a.elf " + elf + " --out " + file)
                            .c_str()),
            0);
  const auto bad = read_firmware_file(file);
  ASSERT_TRUE(bad);
  board->chip.load_program(elf, false);  // where it hangs is a matter of its names
  ASSERT_EQ(starts(), 0u);
  ASSERT_EQ(install(bad->images[1]), 0u);
  const std::uint64_t resets = board->chip.resets;
  EXPECT_EQ(starts_anew(), 0u);
  EXPECT_EQ(board->chip.resets, resets + 1);
}

// The host's tests cut at every operation; here the real driver is cut where it matters: in the erase, in a block, in the
// record, in `whole`; and in `tried`, which the boot program writes: a torn mark is a mark.
TEST_F(F405Update, APowerCutLeavesWhatRan) {
  const std::uint64_t words = (image(1).bytes.size() + 127) / 128 * 32;
  const std::uint64_t record = 21, whole = 1 + words + record + 1;
  for (const std::uint64_t cut :
       {std::uint64_t{1}, 1 + words / 2, 1 + words + record / 2, whole, whole + 1}) {
    board = std::make_unique<F405Board>(folder);
    ASSERT_EQ(starts(), 0u);
    board->flash.operations = 0;
    board->flash.cut_at = cut;
    const unsigned said = install(image(1));
    if (cut <= whole) {
      EXPECT_EQ(said, 255u) << cut;
    } else {
      EXPECT_EQ(said, 0u);
      board->chip.reset();
    }
    EXPECT_EQ(starts(), 0u) << cut;
    EXPECT_EQ(board->chip.resets, 1u) << cut;
    EXPECT_EQ(board->chip.misuses, std::vector<std::string>{}) << cut;
  }
}

}  // namespace
}  // namespace lightwell::test
