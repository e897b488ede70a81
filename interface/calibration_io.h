// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lighting/calibration.h"
#include "lighting/result.h"

namespace lightwell {

// A calibration directory: response.json, lens.json and, where the camera has one, flat.json (schemas in
// docs/conventions.md). Reading checks every field and names file, field, value and range; unknown keys are
// kept quiet, an unknown schema version is an error. Writing is whole or not at all (temporary file, fsync,
// rename), lens.json last.
Result<Calibration> read_calibration(const std::filesystem::path& directory);
Status write_calibration(const std::filesystem::path& directory, const Calibration& calibration);

// The single files.
Result<Response> read_response(const std::filesystem::path& file);
Result<Lens> read_lens(const std::filesystem::path& file);
Result<FlatField> read_flat_field(const std::filesystem::path& file);

// A fixed pattern of a calibration folder and the temperature that its dark frames, or where there were none its even
// ones, were taken at.
struct FlatAtTemperature {
  double temperature_c = 0;
  std::filesystem::path file;
};
// Every flat*.json of the folder that names a temperature, coldest first. bad_input: one of them cannot be read, or two
// have the same temperature.
Result<std::vector<FlatAtTemperature>> flats_by_temperature(const std::filesystem::path& directory);

// The three files as one JSON text and back: what a recording carries as its attachment.
std::string calibration_to_json(const Calibration& calibration);
Result<Calibration> calibration_from_json(const std::string& text, const std::string& name_for_errors);

// 16 hex digits over everything that changes radiance; equal content, equal id.
std::string calibration_id(const Calibration& calibration);

}  // namespace lightwell
