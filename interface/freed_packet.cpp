// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/freed_packet.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace lightwell {
namespace {

constexpr std::size_t kLength = 29;
constexpr std::uint8_t kType = 0xD1;

std::uint32_t unsigned_24(std::span<const std::uint8_t> bytes, std::size_t at) {
  return std::uint32_t{bytes[at]} << 16 | std::uint32_t{bytes[at + 1]} << 8 | bytes[at + 2];
}

double signed_24(std::span<const std::uint8_t> bytes, std::size_t at) {
  const auto value = static_cast<std::int32_t>(unsigned_24(bytes, at));
  return value >= 1 << 23 ? value - (1 << 24) : value;
}

Error bad(const std::string& what) {
  return {ErrorKind::bad_input, "FreeD packet: " + what};
}

std::uint8_t checksum_of(std::span<const std::uint8_t> bytes) {
  std::uint8_t checksum = 0x40;
  for (const std::uint8_t byte : bytes) checksum = static_cast<std::uint8_t>(checksum - byte);
  return checksum;
}

void put_24(std::vector<std::uint8_t>& bytes, double value) {
  const auto whole = static_cast<std::uint32_t>(std::lround(std::clamp(value, -8388608.0, 8388607.0)));
  for (const int shift : {16, 8, 0}) bytes.push_back(static_cast<std::uint8_t>(whole >> shift & 255));
}

}  // namespace

Result<FreedPacket> parse_freed(std::span<const std::uint8_t> bytes) {
  if (bytes.size() != kLength) return bad(std::to_string(bytes.size()) + " bytes, a D1 message has 29");
  if (bytes[0] != kType)
    return bad("message type " + std::to_string(bytes[0]) + ", only D1 (209) says where a camera is");
  if (bytes[kLength - 1] != checksum_of(bytes.first(kLength - 1))) return bad("wrong checksum");
  double angles_deg[3];
  for (std::size_t i = 0; i < 3; ++i) {
    angles_deg[i] = signed_24(bytes, 2 + 3 * i) / 32768;
    if (std::abs(angles_deg[i]) > 180)
      return bad("angle of " + std::to_string(angles_deg[i]) + " degrees, allowed -180 to 180");
  }
  FreedPacket packet;
  packet.camera_id = bytes[1];
  packet.camera.number = bytes[1];
  packet.camera.stage_from_camera = rotation_from_pan_tilt_roll(-angles_deg[0], angles_deg[1], angles_deg[2]);
  for (int i = 0; i < 3; ++i)
    packet.camera.position_m[i] = signed_24(bytes, 11 + 3 * static_cast<std::size_t>(i)) / 64 / 1000;
  packet.zoom = unsigned_24(bytes, 20);
  packet.focus = unsigned_24(bytes, 23);
  return packet;
}

std::vector<std::uint8_t> freed_message(const FreedPacket& packet) {
  std::vector<std::uint8_t> bytes = {kType, packet.camera_id};
  const PanTiltRoll angles = pan_tilt_roll_from(packet.camera.stage_from_camera);
  for (const double angle_deg : {-angles.pan_deg, angles.tilt_deg, angles.roll_deg})
    put_24(bytes, angle_deg * 32768);
  for (int i = 0; i < 3; ++i) put_24(bytes, packet.camera.position_m[i] * 1000 * 64);
  for (const std::uint32_t value : {packet.zoom, packet.focus})
    for (const int shift : {16, 8, 0}) bytes.push_back(static_cast<std::uint8_t>(value >> shift & 255));
  bytes.insert(bytes.end(), {0, 0});
  bytes.push_back(checksum_of(bytes));
  return bytes;
}

}  // namespace lightwell
