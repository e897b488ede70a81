// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "lighting/result.h"

namespace lightwell {

// A raw frame as a binary portable grey map (PGM, P5): what many tools write of a sensor's codes.
struct GreyMap {
  int width = 0, height = 0;
  int bytes_a_sample = 1;          // 1, or 2: little-endian, as cameras send
  std::vector<std::byte> samples;  // [height][width]
};

bool is_grey_map(const std::filesystem::path& file);  // by its first bytes
// bad_input: missing, not P5, truncated, larger than 16384 a side.
Result<GreyMap> read_grey_map(const std::filesystem::path& file);

}  // namespace lightwell
