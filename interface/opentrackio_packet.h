// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "interface/tracking_pose.h"
#include "lighting/result.h"

namespace lightwell {

// Puts together the samples of OpenTrackIO datagrams (SMPTE RIS OSVP, opentrackio.org, "Packet Header"): 16 bytes,
// big-endian: "OTrk", reserved, encoding (1: JSON, 2: CBOR), sequence, offset of the segment, last-segment flag and
// length, Fletcher-16 of all else modulo 256; then the payload. A payload in several segments counts only where all
// come in order. A datagram that begins with { is a JSON sample without a header. CBOR (RFC 8949) holds the same objects:
// text keys, no tags.
// A sample's camera: its transforms composed in their order (translation in metres, pan, tilt and roll in degrees,
// TrackedCamera's frame and right-hand rule, "clockwise around the axis" in the words of the specification), the lens's
// pinholeFocalLength and static.camera.activeSensorPhysicalDimensions.height in millimetres, timing.sampleTimestamp,
// sourceNumber.
class OpenTrackIoReader {
 public:
  // The camera of a finished sample; nothing: more segments are to come, or the sample tells no pose.
  // bad_input: a truncated or damaged datagram, another encoding, what is no sample (fields of other kinds, numbers
  // beyond what cameras have); segments so far are dropped.
  Result<std::optional<TrackedCamera>> take(std::span<const std::uint8_t> datagram);

 private:
  Result<std::optional<TrackedCamera>> fail(const std::string& what);

  std::string payload_;
  std::uint8_t encoding_ = 0;               // of the payload's segments
  std::optional<double> sensor_height_mm_;  // static data come in some samples only
};

// A sample of a camera's pose and sampled_ns as one datagram: JSON, one segment, one transform, metres and degrees.
std::vector<std::uint8_t> opentrackio_datagram(const TrackedCamera& camera, std::uint16_t sequence);

// Fletcher's checksum of two sums modulo 256, the second in the high byte.
std::uint16_t fletcher16(std::span<const std::uint8_t> bytes, std::uint16_t start = 0);

}  // namespace lightwell
