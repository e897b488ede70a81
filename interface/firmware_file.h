// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "interface/sync_protocol.h"
#include "lighting/result.h"

namespace lightwell {

// A release of the sync board's firmware, JSON, lightwell.firmware/1: {schema, board, version [major, minor, patch], images
// [{slot, signature, bytes}]}, signature and bytes in base64. The same program, linked once for each of the two slots; the
// one that does not run is replaced.
struct FirmwareImage {
  std::uint8_t slot = 0;  // 0 or 1
  std::vector<std::uint8_t> bytes;
  std::array<std::uint8_t, SYNC_SIGNATURE_BYTES> signature{};  // of firmware/core/update.h's signed bytes
};
struct FirmwareFile {
  std::string board;  // "stm32f405"
  std::array<std::uint8_t, 3> version{};
  std::vector<FirmwareImage> images;  // one or two, of different slots, none empty
};

// bad_input: unreadable, another schema, a slot twice, a signature of another length, an image without bytes.
Result<FirmwareFile> read_firmware_file(const std::filesystem::path& file);
// Whole or not at all.
Status write_firmware_file(const std::filesystem::path& file, const FirmwareFile& firmware);

}  // namespace lightwell
