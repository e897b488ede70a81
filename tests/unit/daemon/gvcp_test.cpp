// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/gvcp.h"

#include <gtest/gtest.h>

#include <cstring>
#include <string_view>

namespace lightwell {
namespace {

std::vector<std::byte> acknowledgement() {
  std::vector<std::byte> packet(8 + 248);
  packet[3] = std::byte{0x03};
  packet[5] = std::byte{0xf8};
  const auto put = [&](std::size_t at, std::string_view text) {
    std::memcpy(&packet[8 + at], text.data(), text.size());
  };
  put(0x0a, std::string_view("\x00\x11\x22\x33\x44\xff", 6));
  put(0x24, std::string_view("\xc0\xa8\x00\x0a", 4));
  put(0x48, "Maker");
  put(0x68, "A model name of 32 characters ..");  // fills its field: no terminating zero
  put(0xd8, "S123");
  put(0xe8, "roof");
  return packet;
}

TEST(Gvcp, ReadsADiscoveryAcknowledgement) {
  const auto device = parse_discovery_ack(acknowledgement());
  ASSERT_TRUE(device);
  EXPECT_EQ(device->address, "192.168.0.10");
  EXPECT_EQ(device->mac, "00:11:22:33:44:ff");
  EXPECT_EQ(device->manufacturer, "Maker");
  EXPECT_EQ(device->model, "A model name of 32 characters ..");
  EXPECT_EQ(device->serial, "S123");
  EXPECT_EQ(device->user_name, "roof");
}

TEST(Gvcp, RefusesEveryTruncationAndEveryOtherPacket) {
  const auto whole = acknowledgement();
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_FALSE(parse_discovery_ack(std::span(whole).first(size))) << size;
  for (const std::size_t at : {0U, 1U, 2U, 3U}) {  // status and acknowledgement code
    auto other = whole;
    other[at] ^= std::byte{0x80};
    EXPECT_FALSE(parse_discovery_ack(other)) << at;
  }
}

TEST(Gvcp, NobodyAtAnAddressIsNoDevice) {
  // 127.255.255.254 is loopback, and nobody's.
  EXPECT_FALSE(gvcp_probe("127.255.255.254", std::chrono::milliseconds(150)));
  EXPECT_FALSE(gvcp_read_register("127.255.255.254", kGvcpControlPrivilege, std::chrono::milliseconds(150)));
  EXPECT_FALSE(gvcp_probe("not an address", std::chrono::milliseconds(150)));
}

}  // namespace
}  // namespace lightwell
