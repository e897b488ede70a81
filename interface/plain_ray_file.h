// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "interface/ray_file.h"

namespace lightwell {

// Rays as text, one a line, numbers between commas or blanks. Lines that begin with #, ! or ; are passed over. The first
// other line says which of two forms it is:
// - names of columns, x, y, z, u, v, w, flux among them in any order: where a ray starts, metres, its direction, and its
//   flux, lm, in the lamp's frame;
// - two whole numbers, how many rays and their unit of length (0 m, 1 in, 2 cm, 3 ft, 4 mm), as in text source files of
//   Zemax: x y z l m n flux on each line and anything after it; (x, y, z) is (x, −y, −z) of the lamp's frame. Its flux
//   counts as lumens.
// Rays without flux are left out. bad_input: names file, line, field, value and range; a file that is cut short.
Result<RayFile> read_plain_rays(const std::filesystem::path& file);
Result<RayFile> parse_plain_rays(std::string_view text, const std::string& file);

}  // namespace lightwell
