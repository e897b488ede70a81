// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/firmware_update.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <fstream>
#include <random>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "daemon/clock.h"
#include "firmware/core/board.h"
#include "firmware/core/board_requests.h"
#include "tests/support/child_process.h"
#include "tests/support/fake_flash.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

constexpr std::uint32_t kRegion = 16384;
constexpr std::uint32_t kTickHz = 84'000'000;

// In place of a signature: what no other image, version or slot has. Its own strength is not what is tested.
std::array<std::uint8_t, SYNC_SIGNATURE_BYTES> sign(std::span<const std::uint8_t> image,
                                                    const std::uint8_t version[3], std::uint32_t slot) {
  std::seed_seq seed{
      static_cast<std::uint32_t>(std::hash<std::string>()(std::string(image.begin(), image.end()))),
      static_cast<std::uint32_t>(version[0] << 16 | version[1] << 8 | version[2]), slot};
  std::mt19937 random(seed);
  std::array<std::uint8_t, SYNC_SIGNATURE_BYTES> signature{};
  for (auto& byte : signature) byte = static_cast<std::uint8_t>(random());
  return signature;
}

FirmwareFile release(std::uint8_t minor, std::size_t size) {
  FirmwareFile firmware{"stm32f405", {1, minor, 7}, {}};
  std::mt19937 random(minor);
  for (std::uint8_t slot = 0; slot < 2; ++slot) {
    FirmwareImage image;
    image.slot = slot;
    image.bytes.resize(size);
    for (auto& byte : image.bytes) byte = static_cast<std::uint8_t>(random());
    image.signature = sign(image.bytes, firmware.version.data(), slot);
    firmware.images.push_back(image);
  }
  return firmware;
}

// The firmware's core with flash, at the other end of a link that loses, repeats or breaks as it is told.
class Board {
 public:
  explicit Board(std::uint32_t capabilities = SYNC_CAN_UPDATE) {
    verifier_.context = this;
    verifier_.verify = [](void* self, std::uint32_t region, std::uint32_t size, const std::uint8_t version[3],
                          const std::uint8_t signature[SYNC_SIGNATURE_BYTES]) {
      const auto& bytes = static_cast<Board*>(self)->memory.regions.at(region);
      const auto right = sign({bytes.data(), size}, version, region - FLASH_IMAGE_A);
      return std::equal(right.begin(), right.end(), signature);
    };
    facts_.tick_hz = kTickHz;
    facts_.capabilities = capabilities;
    facts_.sample_hz = 5000;
    facts_.highest_code = 4095;
    facts_.memory = &memory.driver;
    facts_.verifier = &verifier_;
    facts_.image_region_size = kRegion;
    board_init(&board_, &facts_, counter());
  }

  class Link final : public SyncLink {
   public:
    explicit Link(Board& at) : board_(at) {}
    Result<std::size_t> read(std::span<std::uint8_t> buffer, std::chrono::milliseconds) override {
      if (board_.unplugged()) return Error{ErrorKind::failed, "the board hung up"};
      board_.turn();
      const std::size_t size = std::min(buffer.size(), board_.to_host_.size());
      std::copy_n(board_.to_host_.begin(), size, buffer.begin());
      board_.to_host_.erase(board_.to_host_.begin(),
                            board_.to_host_.begin() + static_cast<std::ptrdiff_t>(size));
      return size;
    }
    Status write(std::span<const std::uint8_t> bytes) override {
      if (board_.unplugged()) return Error{ErrorKind::failed, "the board hung up"};
      ++board_.written;
      if (board_.lose_every > 0 && board_.written % board_.lose_every == 0) return {};
      const int times = board_.repeat_every > 0 && board_.written % board_.repeat_every == 0 ? 2 : 1;
      for (int i = 0; i < times; ++i)
        for (const std::uint8_t byte : bytes) board_byte(&board_.board_, 0, byte, board_.counter());
      return {};
    }

   private:
    Board& board_;
  };

  [[nodiscard]] std::uint32_t counter() const {
    return static_cast<std::uint32_t>(static_cast<std::uint64_t>(static_cast<double>(mono_now_ns()) * 0.084));
  }
  [[nodiscard]] std::uint32_t starts() const { return update_choose(&memory.driver, &verifier_, kRegion); }

  test::FakeFlash memory{kRegion};
  unsigned written = 0;       // messages of the host
  unsigned lose_every = 0;    // of them
  unsigned repeat_every = 0;  // its answers come twice
  unsigned gone_after = 0;    // the plug is pulled; 0: never

 private:
  [[nodiscard]] bool unplugged() const { return gone_after > 0 && written >= gone_after; }
  void turn() {
    board_poll(&board_, counter());
    board_finish_update(&board_);
    for (std::uint8_t byte = 0; outbox_take(&board_.out, &byte);) to_host_.push_back(byte);
  }

  update_verifier verifier_{};
  board_facts facts_{};
  board board_{};
  std::deque<std::uint8_t> to_host_;
};

void expect_in_slot(const Board& board, const FirmwareImage& image) {
  const auto& region = board.memory.regions.at(FLASH_IMAGE_A + image.slot);
  EXPECT_TRUE(std::equal(image.bytes.begin(), image.bytes.end(), region.begin()));
  EXPECT_EQ(board.starts(), FLASH_IMAGE_A + image.slot);
}

TEST(FirmwareUpdate, TheImageOfTheOtherSlotIsWrittenAndStartsNext) {
  Board board;
  Board::Link link(board);
  const FirmwareFile firmware = release(2, 5000);  // not a whole number of blocks
  std::vector<double> shares;
  const auto before = update_firmware(link, firmware, [&](double share) { shares.push_back(share); });
  ASSERT_TRUE(before) << before.error().message;
  EXPECT_EQ(before->slot, 0);
  expect_in_slot(board, firmware.images[1]);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.size(), 40U);
  EXPECT_EQ(shares.back(), 1);
}

TEST(FirmwareUpdate, LostAndRepeatedMessagesChangeNothing) {
  Board board;
  Board::Link link(board);
  board.lose_every = 7;  // the begin is asked once, as its erase takes long, and is the second message
  board.repeat_every = 5;
  const FirmwareFile firmware = release(3, 3000);
  const auto before = update_firmware(link, firmware, {});
  ASSERT_TRUE(before) << before.error().message;
  expect_in_slot(board, firmware.images[1]);
}

TEST(FirmwareUpdate, AWrongSignatureIsRefusedAndWhatRanRunsOn) {
  Board board;
  Board::Link link(board);
  FirmwareFile forged = release(2, 3000);
  forged.images[1].bytes[1234] ^= 1;
  const auto refused = update_firmware(link, forged, {});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("not signed"), std::string::npos) << refused.error().message;
  EXPECT_EQ(board.starts(), FLASH_REGIONS) << "neither slot holds an image of ours";
  ASSERT_TRUE(update_firmware(link, release(2, 3000), {})) << "the right one is welcome after it";
}

TEST(FirmwareUpdate, APulledPlugLosesNothingAndTheNextTryIsWhole) {
  const FirmwareFile firmware = release(4, 3000);
  for (unsigned messages = 1; messages < 27; ++messages) {
    Board board;
    Board::Link link(board);
    board.gone_after = messages;
    const auto cut = update_firmware(link, firmware, {});
    ASSERT_FALSE(cut) << messages;
    EXPECT_EQ(cut.error().kind, ErrorKind::failed);
    EXPECT_EQ(board.starts(), FLASH_REGIONS) << messages;
    board.gone_after = 0;
    ASSERT_TRUE(update_firmware(link, firmware, {})) << messages;
    expect_in_slot(board, firmware.images[1]);
  }
}

TEST(FirmwareUpdate, WhatCannotBeIsSaidInOneLine) {
  Board board, fixed(0);
  Board::Link link(board), without(fixed);
  const auto unable = update_firmware(without, release(2, 100), {});
  ASSERT_FALSE(unable);
  EXPECT_NE(unable.error().message.find("cannot be updated"), std::string::npos);
  const auto large = update_firmware(link, release(2, kRegion), {});
  ASSERT_FALSE(large);
  EXPECT_NE(large.error().message.find("allowed 1 to"), std::string::npos) << large.error().message;
  FirmwareFile one = release(2, 100);
  one.images.pop_back();
  const auto running = update_firmware(link, one, {});
  ASSERT_FALSE(running);
  EXPECT_EQ(running.error().kind, ErrorKind::bad_input);
  EXPECT_NE(running.error().message.find("slot 0"), std::string::npos);
}

TEST(FirmwareFiles, ComeBackAsTheyWereAndDamageIsNamed) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "firmware.json";
  const FirmwareFile firmware = release(9, 777);
  ASSERT_TRUE(write_firmware_file(file, firmware));
  const auto read = read_firmware_file(file);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->version, firmware.version);
  ASSERT_EQ(read->images.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read->images[i].bytes, firmware.images[i].bytes);
    EXPECT_EQ(read->images[i].signature, firmware.images[i].signature);
  }
  std::string text;
  std::getline(std::ifstream(file), text, '\0');
  const auto damaged = [&](const std::string& from, const std::string& to) {
    std::string other = text;
    const auto at = other.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    other.replace(at, from.size(), to);
    std::ofstream(file) << other;
    const auto refused = read_firmware_file(file);
    EXPECT_FALSE(refused) << from;
    return refused ? std::string() : refused.error().message;
  };
  EXPECT_NE(damaged("firmware/1", "firmware/9").find("schema"), std::string::npos);
  EXPECT_NE(damaged("\"slot\":1", "\"slot\":0").find("each slot once"), std::string::npos);
  EXPECT_NE(damaged("\"signature\":\"", "\"signature\":\"AAAA").find("64 bytes"), std::string::npos);
  EXPECT_NE(damaged("\"bytes\":\"", "\"bytes\":\"!").find("base64"), std::string::npos);
  EXPECT_FALSE(damaged("\"images\"", "\"picture\"").empty());
  EXPECT_FALSE(damaged("]}", "").empty());
}

// The command, against the simulated board, which says that it cannot be updated.
TEST(BoardCommand, ShowsTheBoardAndSaysWhatItCannot) {
  const test::TemporaryFolder folder;
  const std::string bin = LIGHTWELL_BIN_DIR;
  ASSERT_TRUE(write_firmware_file(folder.path() / "firmware.json", release(2, 100)));
  test::ChildProcess::Options output;
  output.stdout_file = folder.path() / "terminal.txt";
  const test::ChildProcess board({bin + "/lightwell-sync-simulator"}, folder.path() / "board.log", output);
  std::string terminal;
  for (int i = 0; i < 300 && terminal.empty(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    std::ifstream(output.stdout_file) >> terminal;
  }
  const std::string address = "serial:" + terminal;
  const auto shown = test::run_process(bin + "/lightwell", {"board", "--address", address, "--json"});
  EXPECT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_NE(shown.out.find("\"timecode\""), std::string::npos) << shown.out;
  const auto refused = test::run_process(
      bin + "/lightwell",
      {"board", "update", (folder.path() / "firmware.json").string(), "--address", address});
  EXPECT_EQ(refused.exit_code, 1) << refused.err;
  const auto nothing = test::run_process(bin + "/lightwell", {"board", "--address", "serial:/dev/nothing"});
  EXPECT_EQ(nothing.exit_code, 1) << nothing.err;
  const auto missing = test::run_process(bin + "/lightwell", {"board", "update", "none.json"});
  EXPECT_EQ(missing.exit_code, 3) << missing.err;
}

}  // namespace
}  // namespace lightwell
