// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lighting/field/field_grid.h"
#include "lighting/result.h"

namespace lightwell {

// Where each picture of a take was made: PROBES.csv, columns x, y, z (metres, world) and file.
struct ProbeList {
  std::vector<Vec3d> positions;
  std::vector<std::filesystem::path>
      files;  // a relative one is looked for beside the list, then as it stands
};

// At least one probe; bad_input that names file, line, column, value and range.
Result<ProbeList> read_probe_list(const std::filesystem::path& file);

// What the probes' places leave undetermined, a line each: all in one place, on a line, in a plane (thinner than half a
// cell), or none inside the grid's bounds.
std::vector<std::string> remarks_on_places(const std::vector<Vec3d>& positions, const FieldGrid& grid);

}  // namespace lightwell
