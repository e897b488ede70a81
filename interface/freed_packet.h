// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "interface/tracking_pose.h"
#include "lighting/result.h"

namespace lightwell {

struct FreedPacket {
  std::uint8_t camera_id = 0;
  TrackedCamera camera;
  std::uint32_t zoom = 0;   // of 24 bits; what a unit is, the tracker's maker says
  std::uint32_t focus = 0;  // likewise
};

// A FreeD message of type D1, 29 bytes (Vinten Radamec, free-d installation manual 1.4.4, A.3.2 and appendix B): 24 bit
// big-endian numbers; pan (to the right is positive), tilt, roll in degrees / 32768; position in millimetres / 64, Z up,
// the camera looks along +Y at zero pan; the checksum is 64 less all other bytes, modulo 256.
// bad_input: another length or type, a wrong checksum, an angle beyond ±180°.
Result<FreedPacket> parse_freed(std::span<const std::uint8_t> bytes);
// The message that says so, without focal length; a position beyond ±131 m, FreeD's own range, is held at its end.
std::vector<std::uint8_t> freed_message(const FreedPacket& packet);

}  // namespace lightwell
