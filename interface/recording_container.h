// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "lighting/result.h"

namespace lightwell {

// The outermost of a Matroska file, read without a demuxer: what tells a whole file from a cut one.
struct SegmentEnd {
  bool has_proper_end = false;      // the segment's size was filled in when the take was closed
  std::uint64_t missing_bytes = 0;  // the file ends before the segment does
};

// nullopt: this is not the beginning of a Matroska file.
std::optional<SegmentEnd> find_segment_end(int fd);

}  // namespace lightwell
