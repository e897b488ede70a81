// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/sync_frame.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes encode(std::uint8_t type, std::uint16_t sequence, const Bytes& payload) {
  Bytes wire(SYNC_MAX_WIRE);
  wire.resize(frame_encode(type, sequence, payload.data(), payload.size(), wire.data()));
  return wire;
}

struct Received {
  std::uint8_t version, type;
  std::uint16_t sequence;
  Bytes payload;
};

std::vector<Received> receive(frame_receiver& receiver, const Bytes& bytes) {
  std::vector<Received> frames;
  for (const std::uint8_t byte : bytes) {
    frame_view view;
    if (frame_receive(&receiver, byte, &view))
      frames.push_back(
          {view.version, view.type, view.sequence, Bytes(view.payload, view.payload + view.payload_size)});
  }
  return frames;
}

frame_receiver fresh() {
  frame_receiver receiver;
  frame_receiver_init(&receiver);
  return receiver;
}

TEST(SyncFrame, CrcIsTheStandardsCheckValue) {
  const std::uint8_t digits[] = "123456789";
  EXPECT_EQ(frame_crc16(digits, 9), 0x29B1);  // CRC-16/CCITT-FALSE, the catalogue's check
}

TEST(SyncFrame, EveryPayloadSizeComesBackWhateverItsZeros) {
  std::mt19937 random(1);
  frame_receiver receiver = fresh();
  for (std::size_t size = 0; size <= SYNC_MAX_PAYLOAD; ++size) {
    for (const unsigned zeros_in_4 : {0u, 1u, 4u}) {
      Bytes payload(size);
      for (auto& byte : payload)
        byte = random() % 4 < zeros_in_4 ? 0 : static_cast<std::uint8_t>(1 + random() % 255);
      const Bytes wire = encode(9, static_cast<std::uint16_t>(size * 257), payload);
      EXPECT_EQ(std::count(wire.begin(), wire.end(), 0), 1);
      ASSERT_LE(wire.size(), SYNC_MAX_WIRE);
      const auto frames = receive(receiver, wire);
      ASSERT_EQ(frames.size(), 1u) << size;
      EXPECT_EQ(frames[0].payload, payload);
      EXPECT_EQ(frames[0].sequence, static_cast<std::uint16_t>(size * 257));
    }
  }
  EXPECT_EQ(receiver.damaged, 0u);
}

TEST(SyncFrame, TooLargePayloadIsRefused) {
  const Bytes payload(SYNC_MAX_PAYLOAD + 1);
  EXPECT_TRUE(encode(1, 0, payload).empty());
}

TEST(SyncFrame, EveryFlippedBitIsNoticed) {
  const Bytes good = encode(3, 7, {1, 0, 2, 0, 0, 3, 255, 4});
  for (std::size_t i = 0; i + 1 < good.size(); ++i)
    for (int bit = 0; bit < 8; ++bit) {
      Bytes bad = good;
      bad[i] = static_cast<std::uint8_t>(bad[i] ^ (1u << bit));
      frame_receiver receiver = fresh();
      EXPECT_TRUE(receive(receiver, bad).empty()) << i << ":" << bit;
    }
}

TEST(SyncFrame, ResynchronisesWithinOneFrameAfterGarbage) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 2000; ++trial) {
    Bytes bytes(random() % 900);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
    const Bytes first = encode(3, 1, {1}), second = encode(3, 2, {2});
    bytes.insert(bytes.end(), first.begin(), first.end());  // may be lost to the garbage before it
    bytes.insert(bytes.end(), second.begin(), second.end());
    frame_receiver receiver = fresh();
    const auto frames = receive(receiver, bytes);
    ASSERT_FALSE(frames.empty());
    EXPECT_EQ(frames.back().sequence, 2);
  }
}

}  // namespace
