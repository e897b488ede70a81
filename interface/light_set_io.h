// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lighting/light_set.h"
#include "lighting/result.h"

namespace lightwell {

// lightwell.lights/1 (docs/conventions.md). Numbers are written so that reading gives the same float.
std::string light_set_to_json(const LightSet& set, bool one_line = false);
// Refuses (bad_input) what is not of the schema, NaN, negative power, directions that are not unit within 1e-3 (then
// normalises), parents that do not point to earlier lights; name_for_errors is the file.
Result<LightSet> light_set_from_json(const std::string& text, const std::string& name_for_errors);

Result<LightSet> read_light_set(const std::filesystem::path& file);
// One set a line, as `lightwell lights` writes of a sequence; blank lines count for nothing. An error names the line.
Result<std::vector<LightSet>> read_light_sets(const std::filesystem::path& file);
Status write_light_set(const std::filesystem::path& file, const LightSet& set);

}  // namespace lightwell
