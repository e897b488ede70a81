// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "lighting/luminaire/lamp_rays.h"
#include "lighting/result.h"

namespace lightwell {

struct RayFile {
  std::vector<LampRay> rays;
  std::string name;
  double stated_flux_lm = 0;  // 0: not said
  std::vector<std::string> remarks;
};

// IES TM-25-13. Positions in millimetres; a file's (x, y, z) is (x, −y, −z) of the lamp's frame. Luminous flux a ray where
// the file has it; else its radiant flux scaled to the header's luminous flux; where there is none either, watts count as
// lumens, which is remarked on. Rays without flux are left out. bad_input: names file, field, value and range; a file
// that is cut short.
Result<RayFile> read_tm25(const std::filesystem::path& file);
Result<RayFile> parse_tm25(std::span<const std::uint8_t> bytes, const std::string& file);

}  // namespace lightwell
