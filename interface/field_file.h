// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "lighting/field/light_field.h"
#include "lighting/result.h"

namespace lightwell {

// A field as OpenVDB, readable in Houdini and Blender: a vector grid (R, G, B) "sh_00", "sh_01" … a harmonic, half floats,
// index l(l + 1) + m (lighting/harmonics.h), and a float grid "confidence". Voxel (i, j, k) is grid point (i, j, k); the
// transform is metres. Metadata: lightwell_schema "lightwell.field/1", lightwell_degree, lightwell_size, lightwell_low,
// lightwell_high, lightwell_method, lightwell_max_error, and lightwell_scale: harmonics are the stored numbers times it
// (1, but where half floats would not hold them).
struct FieldFileOptions {
  std::string method = "best";
  double max_error =
      0;  // above 0: points that coarser ones foretell are left out (lighting/field/field_sparsity.h)
};
struct FieldFileReport {
  std::size_t bytes = 0;
  std::size_t stored_points = 0;
  double rms_error =
      0;  // of what is read, over all points, harmonics and colours, relative to the field's RMS
  double most_error = 0;  // of the worst point, relative to the RMS of points
};
// Written whole or not at all.
Result<FieldFileReport> write_field(const std::filesystem::path& file, const LightField& field,
                                    const FieldFileOptions& options);

struct FieldFile {
  LightField field;  // points that were left out are filled
  std::string method;
  double max_error = 0;
};
// bad_input: missing, not OpenVDB, truncated, not a field of ours, or too large for memory.
Result<FieldFile> read_field(const std::filesystem::path& file);

}  // namespace lightwell
