// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/board.h"

#include <gtest/gtest.h>

#include <cstring>
#include <optional>
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

std::uint64_t u64(const Bytes& bytes, std::size_t at) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 8; ++i) value |= std::uint64_t{bytes.at(at + i)} << (8 * i);
  return value;
}

Bytes fault(std::uint8_t code, std::uint8_t type) {
  Bytes payload(sync_payload_size(SYNC_FAULT));
  payload[0] = code;
  payload[1] = type;
  return payload;
}

// Sends a request to a board; its answer, if any.
std::optional<Received> ask(board& self, const Bytes& wire, std::uint32_t counter_us = 0) {
  Bytes answer(SYNC_MAX_WIRE);
  std::size_t size = 0;
  for (const std::uint8_t byte : wire) {
    const std::size_t n = board_receive(&self, byte, counter_us, answer.data());
    if (n > 0) size = n;
  }
  answer.resize(size);
  frame_receiver receiver = fresh();
  const auto frames = receive(receiver, answer);
  if (frames.empty()) return std::nullopt;
  return frames.front();
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

TEST(Board, HelloCarriesTheSchema) {
  board self;
  board_init(&self, 0);
  const auto answer = ask(self, encode(SYNC_HELLO_REQUEST, 0, {}));
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->type, SYNC_HELLO);
  EXPECT_EQ(static_cast<std::uint32_t>(u64(answer->payload, 0)), SYNC_SCHEMA_HASH);
}

TEST(Board, PingComesBackWithBoardTimeAcrossTheWrap) {
  board self;
  board_init(&self, 0xFFFFFFF0u);
  const auto answer = ask(self, encode(SYNC_PING, 0, {1, 2, 3, 4, 5, 6, 7, 8}), 4);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->type, SYNC_PONG);
  EXPECT_EQ(u64(answer->payload, 0), 0x0807060504030201ull);
  EXPECT_EQ(u64(answer->payload, 8), 0x100000004ull * 1000);
  EXPECT_LE(u64(answer->payload, 8), u64(answer->payload, 16));
}

TEST(Board, WhatItDoesNotKnowIsAFaultThatNamesIt) {
  board self;
  board_init(&self, 0);
  EXPECT_EQ(ask(self, encode(0x55, 0, {}))->payload, fault(SYNC_FAULT_UNKNOWN_TYPE, 0x55));
  EXPECT_EQ(ask(self, encode(SYNC_PING, 0, {1}))->payload, fault(SYNC_FAULT_PAYLOAD_SIZE, SYNC_PING));
}

}  // namespace
