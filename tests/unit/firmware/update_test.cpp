// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/update.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/support/fake_flash.h"

namespace {

using lightwell::test::FakeFlash;
using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t kRegion = 2048;

// In place of a signature: a keyed sum that no other image, version or slot has. Its own strength is not what is tested.
void sign(const Bytes& image, const std::uint8_t version[3], std::uint32_t region,
          std::uint8_t signature[SYNC_SIGNATURE_BYTES]) {
  std::uint64_t state = 0x9E3779B97F4A7C15ull ^ region ^ (std::uint64_t{image.size()} << 20);
  const auto mix = [&](std::uint8_t byte) {
    state = (state ^ byte) * 0xD6E8FEB86659FD93ull;
    state ^= state >> 29;
  };
  for (const std::uint8_t byte : image) mix(byte);
  for (int i = 0; i < 3; ++i) mix(version[i]);
  for (int i = 0; i < SYNC_SIGNATURE_BYTES; ++i) {
    mix(static_cast<std::uint8_t>(i));
    signature[i] = static_cast<std::uint8_t>(state >> 40);
  }
}

class Board {
 public:
  explicit Board(unsigned seed = 1) : memory(kRegion, seed) {
    verifier.context = this;
    verifier.verify = [](void* context, std::uint32_t region, std::uint32_t size,
                         const std::uint8_t version[3], const std::uint8_t signature[SYNC_SIGNATURE_BYTES]) {
      const auto& from = static_cast<Board*>(context)->memory.regions.at(region);
      std::uint8_t right[SYNC_SIGNATURE_BYTES];
      sign(Bytes(from.begin(), from.begin() + size), version, region, right);
      return std::equal(right, right + SYNC_SIGNATURE_BYTES, signature);
    };
    // As it leaves the bench: image 0 in A, which runs and is confirmed.
    update_init(&self, &memory.driver, &verifier, kRegion, FLASH_IMAGE_B);
    install(image(0, 300), FLASH_IMAGE_A);
    EXPECT_EQ(boot(), FLASH_IMAGE_A);
    EXPECT_TRUE(update_confirm(&self));
  }

  static Bytes image(unsigned number, std::size_t size) {
    std::mt19937 random(number);
    Bytes bytes(size);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
    return bytes;
  }

  // The host's side of an update; the first fault, or 0.
  std::uint8_t install(const Bytes& bytes, std::uint32_t region, bool forged = false) {
    const std::uint8_t version[3] = {1, 2, 3};
    sync_update_begin begin{static_cast<std::uint32_t>(bytes.size()), {1, 2, 3}};
    if (const auto fault = update_begin(&self, &begin)) return fault;
    for (std::size_t at = 0; at < bytes.size(); at += SYNC_UPDATE_BLOCK_BYTES) {
      sync_update_block block{};
      block.offset = static_cast<std::uint32_t>(at);
      for (std::size_t i = 0; i < SYNC_UPDATE_BLOCK_BYTES; ++i)
        block.bytes[i] = at + i < bytes.size() ? bytes[at + i] : std::uint8_t{0xFF};
      if (const auto fault = update_block(&self, &block)) return fault;
    }
    sync_update_finish finish{};
    sign(bytes, version, region, finish.signature);
    if (forged) finish.signature[17] ^= 1;
    if (const auto fault = update_finish(&self, &finish)) return fault;
    EXPECT_TRUE(self.unverified);
    return update_verify(&self);
  }

  std::uint32_t boot() {
    const std::uint32_t region = update_choose(&memory.driver, &verifier, kRegion);
    if (region != FLASH_REGIONS) update_init(&self, &memory.driver, &verifier, kRegion, region);
    return region;
  }

  bool holds(std::uint32_t region, const Bytes& bytes) const {
    return std::equal(bytes.begin(), bytes.end(), memory.regions.at(region).begin());
  }

  FakeFlash memory;
  update_verifier verifier{};
  update self{};
};

TEST(Update, ANewImageRunsAndIsKeptOnceConfirmed) {
  Board board;
  const Bytes second = Board::image(1, 1000);
  ASSERT_EQ(board.install(second, FLASH_IMAGE_B), 0);
  EXPECT_EQ(board.self.step, SYNC_UPDATE_PENDING);
  ASSERT_EQ(board.boot(), FLASH_IMAGE_B);
  EXPECT_TRUE(board.holds(FLASH_IMAGE_B, second));
  ASSERT_TRUE(update_confirm(&board.self));
  ASSERT_TRUE(update_confirm(&board.self));  // writes nothing
  EXPECT_EQ(board.boot(), FLASH_IMAGE_B);
  ASSERT_EQ(board.install(Board::image(2, kRegion - UPDATE_TRAILER), FLASH_IMAGE_A), 0);
  EXPECT_EQ(board.boot(), FLASH_IMAGE_A);
  EXPECT_EQ(board.memory.misuses, 0);
}

TEST(Update, AnImageThatIsNeverConfirmedIsLeftAtTheNextStart) {
  Board board;
  ASSERT_EQ(board.install(Board::image(1, 1000), FLASH_IMAGE_B), 0);
  EXPECT_EQ(board.boot(), FLASH_IMAGE_B);
  EXPECT_EQ(board.boot(), FLASH_IMAGE_A);
  EXPECT_EQ(board.boot(), FLASH_IMAGE_A);
  ASSERT_EQ(board.install(Board::image(2, 500), FLASH_IMAGE_B), 0);  // and the next one has its chance
  EXPECT_EQ(board.boot(), FLASH_IMAGE_B);
}

TEST(Update, AWrongSignatureNeverBoots) {
  Board board;
  EXPECT_EQ(board.install(Board::image(1, 1000), FLASH_IMAGE_B, true), SYNC_FAULT_SIGNATURE);
  EXPECT_EQ(board.boot(), FLASH_IMAGE_A);
  // Signed for the other slot.
  EXPECT_EQ(board.install(Board::image(1, 1000), FLASH_IMAGE_A), SYNC_FAULT_SIGNATURE);
  EXPECT_EQ(board.boot(), FLASH_IMAGE_A);
  // A good image of which one bit changes afterwards, anywhere in the image or its record.
  ASSERT_EQ(board.install(Board::image(1, 200), FLASH_IMAGE_B), 0);
  const auto good = board.memory.regions[FLASH_IMAGE_B];
  const auto other = board.memory.regions[FLASH_IMAGE_A];
  for (std::size_t i = 0; i < good.size(); ++i) {
    const bool image = i < 200;
    const bool record = i >= kRegion - UPDATE_TRAILER && i < kRegion - UPDATE_TRAILER + 88;
    if (!image && !record) continue;
    for (int bit = 0; bit < 8; ++bit) {
      board.memory.regions[FLASH_IMAGE_A] = other;
      board.memory.regions[FLASH_IMAGE_B] = good;
      board.memory.regions[FLASH_IMAGE_B][i] ^= static_cast<std::uint8_t>(1u << bit);
      ASSERT_EQ(board.boot(), FLASH_IMAGE_A) << i;
    }
  }
}

TEST(Update, ABoardWithoutAVerifierTakesNothing) {
  Board board;
  board.verifier.verify = update_verify_none;
  EXPECT_EQ(board.install(Board::image(1, 1000), FLASH_IMAGE_B), SYNC_FAULT_SIGNATURE);
  EXPECT_EQ(board.boot(), FLASH_REGIONS);
}

TEST(Update, StepsOutOfOrderAreRefusedAndARepeatedBlockIsWelcome) {
  Board board;
  sync_update_block block{};
  sync_update_finish finish{};
  EXPECT_EQ(update_block(&board.self, &block), SYNC_FAULT_SEQUENCE);
  EXPECT_EQ(update_finish(&board.self, &finish), SYNC_FAULT_SEQUENCE);
  sync_update_begin begin{0, {}};
  EXPECT_EQ(update_begin(&board.self, &begin), SYNC_FAULT_RANGE);
  begin.size = kRegion - UPDATE_TRAILER + 1;
  EXPECT_EQ(update_begin(&board.self, &begin), SYNC_FAULT_RANGE);
  begin.size = 200;
  EXPECT_EQ(update_begin(&board.self, &begin), 0);
  block.offset = SYNC_UPDATE_BLOCK_BYTES;
  EXPECT_EQ(update_block(&board.self, &block), SYNC_FAULT_SEQUENCE);
  block.offset = 0;
  EXPECT_EQ(update_block(&board.self, &block), 0);
  EXPECT_EQ(update_block(&board.self, &block), 0);
  EXPECT_EQ(update_finish(&board.self, &finish), SYNC_FAULT_SEQUENCE);  // not all is here
  block.offset = SYNC_UPDATE_BLOCK_BYTES;
  EXPECT_EQ(update_block(&board.self, &block), 0);
  block.offset = 2 * SYNC_UPDATE_BLOCK_BYTES;
  EXPECT_EQ(update_block(&board.self, &block), SYNC_FAULT_SEQUENCE);
  EXPECT_EQ(board.memory.misuses, 0);
}

// Every flash operation of: an update, the start after it, its confirmation. After each cut the board starts one of the
// two whole images; and then takes an update as if nothing had been.
TEST(Update, APowerCutAtEveryFlashOperationAlwaysLeavesAnImageThatBoots) {
  const Bytes second = Board::image(1, 500);
  std::uint64_t all = 0;
  {
    Board board;
    const std::uint64_t before = board.memory.operations;
    ASSERT_EQ(board.install(second, FLASH_IMAGE_B), 0);
    ASSERT_EQ(board.boot(), FLASH_IMAGE_B);
    ASSERT_TRUE(update_confirm(&board.self));
    all = board.memory.operations - before;
  }
  ASSERT_GT(all, 125u);
  for (std::uint64_t cut = 0; cut <= all; ++cut)
    for (unsigned seed = 0; seed < 20; ++seed) {
      Board board(seed);
      const Bytes first = Board::image(0, 300);
      board.memory.cut_power_at(cut);
      if (board.install(second, FLASH_IMAGE_B) == 0 && board.boot() != FLASH_REGIONS)
        update_confirm(&board.self);
      board.memory.restore_power();
      for (int start = 0; start < 3; ++start) {
        const std::uint32_t region = board.boot();
        ASSERT_NE(region, FLASH_REGIONS) << cut;
        ASSERT_TRUE(board.holds(region, region == FLASH_IMAGE_A ? first : second)) << cut;
      }
      const std::uint32_t running = board.boot();
      const std::uint32_t other = running == FLASH_IMAGE_A ? FLASH_IMAGE_B : FLASH_IMAGE_A;
      ASSERT_EQ(board.install(Board::image(3, 700), other), 0) << cut;
      ASSERT_EQ(board.boot(), other) << cut;
      ASSERT_EQ(board.memory.misuses, 0) << cut;
    }
}

// The power fails again and again at random, through a year of updates.
TEST(Update, AThousandRandomCutsNeverLeaveABoardWithoutAnImage) {
  std::mt19937 random(7);
  Board board(7);
  for (int i = 0; i < 1000; ++i) {
    board.memory.cut_power_at(random() % 300);
    const std::uint32_t other = board.self.running == FLASH_IMAGE_A ? FLASH_IMAGE_B : FLASH_IMAGE_A;
    if (board.install(Board::image(static_cast<unsigned>(random()), 100 + random() % 900), other) == 0) {
      board.boot();
      if (random() % 2 == 0) update_confirm(&board.self);
    }
    board.memory.restore_power();
    ASSERT_NE(board.boot(), FLASH_REGIONS) << i;
    if (random() % 2 == 0) update_confirm(&board.self);
  }
  EXPECT_EQ(board.memory.misuses, 0);
}

}  // namespace
