// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The boot program's decision with its real verifier: what it verifies, and that no power cut leaves it without an image. That
// it agrees with OpenSSL's signatures is seen where the build's own images start (firmware_f405).
#include "firmware/signature/image_signature.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <random>
#include <vector>

#include "monocypher-ed25519.h"
#include "tests/support/fake_flash.h"

namespace lightwell::test {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t kRegion = 2048;
constexpr std::uint8_t kVersion[3] = {1, 2, 3};

class SignedBoard {
 public:
  explicit SignedBoard(unsigned seed = 1) : memory(kRegion, seed) {
    std::array<std::uint8_t, 32> secret{};
    std::iota(secret.begin(), secret.end(), std::uint8_t{7});
    crypto_ed25519_key_pair(private_key.data(), public_key.data(), secret.data());
    signer = {&memory.driver, public_key.data()};
    verifier = {&signer, image_signature_verify};
    update_init(&self, &memory.driver, &verifier, kRegion, FLASH_IMAGE_B);
    install(image(0, 300), FLASH_IMAGE_A);
    EXPECT_EQ(boot(), unsigned{FLASH_IMAGE_A});
    EXPECT_TRUE(update_confirm(&self));
  }
  static Bytes image(unsigned number, std::size_t size) {
    std::mt19937 random(number);
    Bytes bytes(size);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
    return bytes;
  }
  std::array<std::uint8_t, 64> sign(Bytes bytes, std::uint32_t region) const {
    const auto size = static_cast<std::uint32_t>(bytes.size());
    bytes.insert(bytes.end(), kVersion, kVersion + 3);
    bytes.push_back(static_cast<std::uint8_t>(region - FLASH_IMAGE_A));
    for (unsigned i = 0; i < 4; ++i) bytes.push_back(static_cast<std::uint8_t>(size >> (8 * i)));
    std::array<std::uint8_t, 64> digest{}, signature{};
    crypto_sha512(digest.data(), bytes.data(), bytes.size());
    crypto_ed25519_sign(signature.data(), private_key.data(), digest.data(), digest.size());
    return signature;
  }
  std::uint8_t install(const Bytes& bytes, std::uint32_t region) {
    const sync_update_begin begin{static_cast<std::uint32_t>(bytes.size()), {1, 2, 3}};
    if (const auto fault = update_begin(&self, &begin)) return fault;
    for (std::size_t at = 0; at < bytes.size(); at += SYNC_UPDATE_BLOCK_BYTES) {
      sync_update_block block{};
      block.offset = static_cast<std::uint32_t>(at);
      for (std::size_t i = 0; i < SYNC_UPDATE_BLOCK_BYTES; ++i)
        block.bytes[i] = at + i < bytes.size() ? bytes[at + i] : std::uint8_t{0xFF};
      if (const auto fault = update_block(&self, &block)) return fault;
    }
    sync_update_finish finish{};
    const auto signature = sign(bytes, region);
    std::copy(signature.begin(), signature.end(), finish.signature);
    if (const auto fault = update_finish(&self, &finish)) return fault;
    return update_verify(&self);
  }
  std::uint32_t boot() {
    const std::uint32_t region = update_choose(&memory.driver, &verifier, kRegion);
    if (region != FLASH_REGIONS) update_init(&self, &memory.driver, &verifier, kRegion, region);
    return region;
  }

  FakeFlash memory;
  std::array<std::uint8_t, 64> private_key{};
  std::array<std::uint8_t, IMAGE_SIGNATURE_KEY> public_key{};
  image_signer signer{};
  update_verifier verifier{};
  update self{};
};

// Of sizes around SHA-512's block and the reader's chunk.
TEST(ImageSignature, HoldsForTheImageItsVersionSlotAndSizeAndNothingElse) {
  SignedBoard board;
  for (const std::size_t size : {1u, 63u, 64u, 65u, 119u, 120u, 128u, 1000u}) {
    const Bytes bytes = SignedBoard::image(static_cast<unsigned>(size), size);
    auto& region = board.memory.regions.at(FLASH_IMAGE_B);
    std::copy(bytes.begin(), bytes.end(), region.begin());
    const auto signature = board.sign(bytes, FLASH_IMAGE_B);
    const auto length = static_cast<std::uint32_t>(size);
    const auto holds = [&](std::uint32_t slot, std::uint32_t said, const std::uint8_t* version,
                           const std::array<std::uint8_t, 64>& by) {
      return image_signature_verify(&board.signer, slot, said, version, by.data());
    };
    ASSERT_TRUE(holds(FLASH_IMAGE_B, length, kVersion, signature)) << size;
    EXPECT_FALSE(holds(FLASH_IMAGE_B, length + 1, kVersion, signature));
    EXPECT_FALSE(holds(FLASH_IMAGE_B, length - 1, kVersion, signature));
    const std::uint8_t other[3] = {1, 2, 4};
    EXPECT_FALSE(holds(FLASH_IMAGE_B, length, other, signature));
    std::copy(bytes.begin(), bytes.end(), board.memory.regions.at(FLASH_IMAGE_A).begin());
    EXPECT_FALSE(holds(FLASH_IMAGE_A, length, kVersion, signature)) << "signed for the other slot";
    for (std::size_t bit = 0; bit < 512; bit += 7) {
      auto changed = signature;
      changed[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
      EXPECT_FALSE(holds(FLASH_IMAGE_B, length, kVersion, changed)) << bit;
    }
    for (std::size_t at = 0; at < size; at += 61) {
      region[at] ^= 0x20;
      EXPECT_FALSE(holds(FLASH_IMAGE_B, length, kVersion, signature)) << at;
      region[at] ^= 0x20;
    }
    board.public_key[3] ^= 1;
    EXPECT_FALSE(holds(FLASH_IMAGE_B, length, kVersion, signature)) << "another's key";
    board.public_key[3] ^= 1;
  }
}

// Every flash operation of an update, the start after it and its confirmation, by the code that runs on the chip.
TEST(ImageSignature, APowerCutAtEveryFlashOperationLeavesASignedImage) {
  const Bytes second = SignedBoard::image(1, 500);
  std::uint64_t all = 0;
  {
    SignedBoard board;
    const std::uint64_t before = board.memory.operations;
    ASSERT_EQ(board.install(second, FLASH_IMAGE_B), 0);
    ASSERT_EQ(board.boot(), unsigned{FLASH_IMAGE_B});
    ASSERT_TRUE(update_confirm(&board.self));
    all = board.memory.operations - before;
  }
  ASSERT_GT(all, 125u);
  for (std::uint64_t cut = 0; cut <= all; ++cut)
    for (unsigned seed = 0; seed < 3; ++seed) {
      SignedBoard board(seed);
      board.memory.cut_power_at(cut);
      if (board.install(second, FLASH_IMAGE_B) == 0 && board.boot() != FLASH_REGIONS)
        update_confirm(&board.self);
      board.memory.restore_power();
      const std::uint32_t region = board.boot();
      ASSERT_NE(region, unsigned{FLASH_REGIONS}) << cut;
      const Bytes& runs = region == FLASH_IMAGE_A ? SignedBoard::image(0, 300) : second;
      ASSERT_TRUE(std::equal(runs.begin(), runs.end(), board.memory.regions.at(region).begin())) << cut;
      const std::uint32_t other = region == FLASH_IMAGE_A ? FLASH_IMAGE_B : FLASH_IMAGE_A;
      ASSERT_EQ(board.install(SignedBoard::image(3, 700), other), 0) << cut;
      ASSERT_EQ(board.boot(), other) << cut;
      ASSERT_EQ(board.memory.misuses, 0) << cut;
    }
}

}  // namespace
}  // namespace lightwell::test
