// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "lighting/luminaire/luminaire.h"
#include "lighting/result.h"

namespace lightwell {

// A lamp as an EXR file: R, G, B of the images of its near field side by side, candela, position (u, v) in column u and row
// v; of a lamp without one its far field's table, a row a plane. Text attribute lightwell_luminaire, JSON: schema
// "lightwell.luminaire/1", name, `near` (positions, spacing_m, first_m, z_m, map, distance_m, pixels, low_m, high_m) and
// `far` (system, horizontal_deg, vertical_deg, candela).
// Written whole or not at all.
Status write_luminaire(const std::filesystem::path& file, const Luminaire& lamp);
// bad_input: missing, no EXR, truncated, or no lamp of ours; names file, field, value and range.
Result<Luminaire> read_luminaire(const std::filesystem::path& file);

}  // namespace lightwell
