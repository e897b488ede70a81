// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lightwell {

// As much of the GigE Vision Control Protocol as it takes to find a device without taking control of it
// (GigE Vision 2.0, sections 15 and 16: DISCOVERY, READREG). Every call ends within its timeout.

// What a device says of itself.
struct GvcpDevice {
  std::string address;  // IPv4, dotted
  std::string manufacturer;
  std::string model;
  std::string version;
  std::string serial;
  std::string user_name;
  std::string mac;  // "00:11:22:33:44:55"
};

inline constexpr std::uint16_t kGvcpPort = 3956;
inline constexpr std::uint32_t kGvcpControlPrivilege =
    0x0a00;  // register: not 0 while a program controls the device

// Asks one address; nullopt where nothing answers.
std::optional<GvcpDevice> gvcp_probe(const std::string& address, std::chrono::milliseconds timeout);
// Asks on every interface that is up, by broadcast; on the loopback interface by its addresses. Sorted by
// address.
std::vector<GvcpDevice> gvcp_discover(std::chrono::milliseconds timeout,
                                      const std::vector<std::string>& interfaces = {});
std::optional<std::uint32_t> gvcp_read_register(const std::string& address, std::uint32_t reg,
                                                std::chrono::milliseconds timeout);
// The device in a DISCOVERY acknowledgement, nullopt where the bytes are anything else.
std::optional<GvcpDevice> parse_discovery_ack(std::span<const std::byte> packet);

}  // namespace lightwell
