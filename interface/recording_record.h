// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "interface/recording.h"

namespace lightwell {

// The record that travels beside every frame as the Matroska block's additional data (docs/conventions.md):
// little-endian, fixed length, its own checksum last.
struct FrameRecord {
  std::uint64_t index =
      0;  // counts the frames of the take from 0: a gap is damage, not a frame the camera lost
  RecordedFrame frame;
  bool verbatim = false;          // the codes follow the record, because the picture cannot hold them
  std::uint32_t codes_crc32 = 0;  // over the codes as the camera sent them
};

constexpr std::size_t kFrameRecordBytes = 76;

std::array<std::byte, kFrameRecordBytes> pack_record(const FrameRecord& record);
// nullopt: too short, not a record, or damaged. More bytes may follow the record.
std::optional<FrameRecord> unpack_record(std::span<const std::byte> bytes);

// CRC-32 (IEEE 802.3, reflected), as zlib and Matroska have it.
std::uint32_t crc32(std::span<const std::byte> bytes);

}  // namespace lightwell
