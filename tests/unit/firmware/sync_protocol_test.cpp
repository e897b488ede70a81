// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/sync_protocol.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "interface/sync_frame.h"

namespace {

using Bytes = std::vector<std::uint8_t>;

std::vector<std::uint8_t> types() {
  std::vector<std::uint8_t> known;
  sync_field_list list;
  for (unsigned type = 0; type < 256; ++type)
    if (sync_fields(static_cast<std::uint8_t>(type), &list)) known.push_back(static_cast<std::uint8_t>(type));
  return known;
}

Bytes random_payload(std::uint8_t type, std::mt19937& random) {
  Bytes payload(sync_payload_size(type));
  for (auto& byte : payload) byte = static_cast<std::uint8_t>(random());
  return payload;
}

TEST(SyncProtocol, SchemaHashIsThatOfTheTables) {
  EXPECT_EQ(sync_schema_hash(), SYNC_SCHEMA_HASH) << std::hex << "now 0x" << sync_schema_hash();
}

TEST(SyncProtocol, EveryMessageFitsAFrameAndNoNameOccursTwiceInIt) {
  EXPECT_EQ(types().size(), 22u);
  for (const std::uint8_t type : types()) {
    EXPECT_LE(sync_payload_size(type), SYNC_MAX_PAYLOAD) << int{type};
    sync_field_list list;
    ASSERT_TRUE(sync_fields(type, &list));
    std::set<std::string> names;
    for (std::size_t i = 0; i < list.count; ++i) EXPECT_TRUE(names.insert(list.fields[i].name).second);
  }
}

// A byte of the payload that no field carries, or that two share, would come back changed.
TEST(SyncProtocol, EveryPayloadComesBackByteForByte) {
  std::mt19937 random(1);
  for (const std::uint8_t type : types())
    for (int trial = 0; trial < 50; ++trial) {
      const Bytes payload = random_payload(type, random);
      sync_message message;
      std::memset(&message, 0xA5, sizeof message);
      ASSERT_TRUE(sync_unpack(type, payload.data(), payload.size(), &message));
      Bytes again(SYNC_MAX_PAYLOAD);
      again.resize(sync_pack(&message, again.data()));
      EXPECT_EQ(again, payload) << int{type};
    }
}

TEST(SyncProtocol, OtherSizesAndTypesAreRefusedAndTouchNothing) {
  const Bytes payload(SYNC_MAX_PAYLOAD, 0x11);
  sync_message message;
  std::memset(&message, 0xA5, sizeof message);
  const sync_message before = message;
  for (unsigned type = 0; type < 256; ++type) {
    const std::size_t right = sync_payload_size(static_cast<std::uint8_t>(type));
    for (std::size_t size = 0; size <= payload.size(); ++size) {
      if (size == right) continue;
      EXPECT_FALSE(sync_unpack(static_cast<std::uint8_t>(type), payload.data(), size, &message));
    }
  }
  EXPECT_EQ(std::memcmp(&message, &before, sizeof message), 0);
  message.type = 0x55;
  Bytes wire(SYNC_MAX_WIRE);
  EXPECT_EQ(sync_pack(&message, wire.data()), SIZE_MAX);
  EXPECT_EQ(frame_encode_message(&message, 0, wire.data()), 0u);
}

// Written by hand from the header's words: the tables and their reader cannot agree on another order.
TEST(SyncProtocol, BytesAreThoseTheHeaderDescribes) {
  sync_message message{};
  message.type = SYNC_TRIGGER;
  message.trigger = {0x04030201u, 0x1112131415161718ull, -2, SYNC_TRIGGER_LOCKED | SYNC_TRIGGER_SLEWING};
  Bytes payload(SYNC_MAX_PAYLOAD);
  payload.resize(sync_pack(&message, payload.data()));
  EXPECT_EQ(payload, (Bytes{1, 2, 3, 4, 0x18, 0x17, 0x16, 0x15, 0x14, 0x13, 0x12, 0x11, 0xFE, 0xFF, 0xFF,
                            0xFF, 5, 0}));
  message.type = SYNC_FAULT;
  message.fault = {SYNC_FAULT_RANGE, SYNC_CONFIGURE, 3, -1, 256};
  payload.resize(SYNC_MAX_PAYLOAD);
  payload.resize(sync_pack(&message, payload.data()));
  EXPECT_EQ(payload, (Bytes{4, 5, 3, 255, 255, 255, 255, 255, 255, 255, 255, 0, 1, 0, 0, 0, 0, 0, 0}));
}

TEST(SyncProtocol, ExtremesOfEveryFieldSurviveAFrame) {
  for (const std::uint8_t type : types())
    for (const int fill : {0x00, 0xFF, 0x80, 0x7F}) {
      const Bytes payload(sync_payload_size(type), static_cast<std::uint8_t>(fill));
      sync_message sent{};
      ASSERT_TRUE(sync_unpack(type, payload.data(), payload.size(), &sent));
      Bytes wire(SYNC_MAX_WIRE);
      wire.resize(frame_encode_message(&sent, 0xFFFF, wire.data()));
      frame_receiver receiver;
      frame_receiver_init(&receiver);
      frame_view view{};
      bool good = false;
      for (const std::uint8_t byte : wire) good = frame_receive(&receiver, byte, &view);
      ASSERT_TRUE(good);
      sync_message got{};
      ASSERT_TRUE(frame_message(&view, &got));
      Bytes again(SYNC_MAX_PAYLOAD);
      again.resize(sync_pack(&got, again.data()));
      EXPECT_EQ(again, payload);
    }
}

TEST(SyncProtocol, AFrameOfAnotherVersionIsNoMessage) {
  const frame_view view{SYNC_PROTOCOL_VERSION - 1, SYNC_HELLO_REQUEST, 0, nullptr, 0};
  sync_message message{};
  EXPECT_FALSE(frame_message(&view, &message));
}

// A reference for COBS by its definition on the whole packet: split at zeros, each piece in blocks of 254.
Bytes cobs_by_definition(const Bytes& packet) {
  Bytes out;
  std::size_t at = 0;
  bool open = true;  // a group is owed: at the start and after every zero
  while (open) {
    open = false;
    std::size_t end = at;
    while (end < packet.size() && packet[end] != 0) ++end;
    std::size_t left = end - at;
    while (left >= 254) {
      out.push_back(255);
      out.insert(out.end(), packet.begin() + static_cast<std::ptrdiff_t>(at),
                 packet.begin() + static_cast<std::ptrdiff_t>(at + 254));
      at += 254;
      left -= 254;
    }
    out.push_back(static_cast<std::uint8_t>(left + 1));
    out.insert(out.end(), packet.begin() + static_cast<std::ptrdiff_t>(at),
               packet.begin() + static_cast<std::ptrdiff_t>(end));
    at = end;
    if (at < packet.size()) {
      ++at;
      open = true;
    }
  }
  return out;
}

std::uint16_t crc_by_definition(const Bytes& bytes) {
  // Long division of the message, as bits, by x^16 + x^12 + x^5 + 1.
  std::vector<bool> bits;
  for (const std::uint8_t byte : bytes)
    for (int i = 7; i >= 0; --i) bits.push_back((byte >> i & 1) != 0);
  bits.resize(bits.size() + 16);
  for (std::size_t i = 0; i < 16; ++i) bits[i] = !bits[i];  // start value 0xFFFF
  for (std::size_t i = 0; i + 16 < bits.size(); ++i)
    if (bits[i])
      for (const std::size_t tap : {0u, 4u, 11u, 16u}) bits[i + tap] = !bits[i + tap];
  unsigned rest = 0;
  for (std::size_t i = bits.size() - 16; i < bits.size(); ++i) rest = rest << 1 | (bits[i] ? 1u : 0u);
  return static_cast<std::uint16_t>(rest);
}

TEST(SyncProtocol, FramesAreCobsAndCrcByTheirDefinitions) {
  std::mt19937 random(3);
  for (std::size_t size = 0; size <= SYNC_MAX_PAYLOAD; size += 1 + random() % 3) {
    Bytes payload(size);
    for (auto& byte : payload) byte = static_cast<std::uint8_t>(random() % 8 == 0 ? 0 : random());
    Bytes packet = {SYNC_PROTOCOL_VERSION, 0x42, 0x34, 0x12};
    packet.insert(packet.end(), payload.begin(), payload.end());
    const std::uint16_t crc = crc_by_definition(packet);
    packet.push_back(static_cast<std::uint8_t>(crc));
    packet.push_back(static_cast<std::uint8_t>(crc >> 8));
    Bytes expected = cobs_by_definition(packet);
    expected.push_back(0);
    Bytes wire(SYNC_MAX_WIRE);
    wire.resize(frame_encode(0x42, 0x1234, payload.data(), payload.size(), wire.data()));
    EXPECT_EQ(wire, expected) << size;
  }
}

// Streams of good frames, damaged in every way that a wire damages: flipped, lost, doubled and inserted bytes, cut
// frames, noise. What the receiver delivers is held against what was sent.
class Damager {
 public:
  explicit Damager(unsigned seed) : random_(seed) {}

  Bytes frame() {
    const std::uint8_t type = known_[random_() % known_.size()];
    const Bytes payload = random_payload(type, random_);
    Bytes wire(SYNC_MAX_WIRE);
    wire.resize(frame_encode(type, static_cast<std::uint16_t>(random_()), payload.data(), payload.size(),
                             wire.data()));
    return wire;
  }

  Bytes damaged(Bytes wire) {
    const auto at = static_cast<std::ptrdiff_t>(random_() % wire.size());
    switch (random_() % 6) {
      case 0:
        wire[static_cast<std::size_t>(at)] ^= static_cast<std::uint8_t>(1u << random_() % 8);
        break;
      case 1:
        wire[static_cast<std::size_t>(at)] = static_cast<std::uint8_t>(random_());
        break;
      case 2:
        wire.erase(wire.begin() + at);
        break;
      case 3:
        wire.insert(wire.begin() + at, static_cast<std::uint8_t>(random_()));
        break;
      case 4:
        wire.resize(static_cast<std::size_t>(at));
        break;
      default:
        for (auto i = random_() % 40; i > 0; --i) wire.push_back(static_cast<std::uint8_t>(random_()));
    }
    return wire;
  }

 private:
  std::vector<std::uint8_t> known_ = types();
  std::mt19937 random_;
};

TEST(SyncProtocol, AMillionDamagedFramesAreRefusedOrWholeAndTheNextOneArrives) {
  constexpr int kTrials = 1'000'000;
  Damager damager(4);
  frame_receiver receiver;
  frame_receiver_init(&receiver);
  int whole = 0, wrong = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Bytes sent = damager.frame();
    frame_view view;
    sync_message message;
    for (const std::uint8_t byte : damager.damaged(sent))
      if (frame_receive(&receiver, byte, &view)) {
        ASSERT_LE(view.payload_size, SYNC_MAX_PAYLOAD);
        frame_message(&view, &message);
        Bytes again(SYNC_MAX_WIRE);
        again.resize(frame_encode(view.type, view.sequence, view.payload, view.payload_size, again.data()));
        ++(again == sent ? whole : wrong);
      }
    if (trial % 16 != 0) continue;
    // One frame may be joined to the garbage before it; the one after it must come.
    const Bytes first = damager.frame(), second = damager.frame();
    for (const std::uint8_t byte : first) frame_receive(&receiver, byte, &view);
    bool arrived = false;
    for (const std::uint8_t byte : second) arrived = frame_receive(&receiver, byte, &view);
    ASSERT_TRUE(arrived) << trial;
  }
  EXPECT_GT(whole, kTrials / 20);  // noise behind a frame takes nothing from it
  EXPECT_GT(receiver.damaged, kTrials / 2u);
  // A CRC of 16 bits passes one piece of garbage in 65536; the mean here is below 20, and 60 is nine sigma off.
  EXPECT_LE(wrong, 60);
}

}  // namespace
