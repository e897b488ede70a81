// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lighting/luminaire/far_field.h"
#include "lighting/result.h"

namespace lightwell {

// What a file of photometric data says of a lamp. Symmetries are unfolded, multipliers applied: candela are candela.
struct PhotometricFile {
  FarField lamp;
  std::string name;  // what the file calls it
  // Lamps' flux times what the luminaire lets out, lm, where the file says both; absolute photometry says neither.
  std::optional<double> stated_flux_lm;
  double input_power_w = 0;  // 0: not said
  // Of the luminous opening along X, Y, Z, metres; 0: a point along it. Round: a disc or sphere of that width.
  Vec3d opening_m = Vec3d::Zero();
  bool round_opening = false;
  // Where the luminaire is turned about X: factors on its candela by the angle from the position it was measured in
  // (LM-63's TILT). Empty: none.
  std::vector<double> tilt_deg, tilt_factor;
  std::vector<std::string> remarks;  // what was repaired or left out, a line each
};

// The factor for a luminaire that is turned so far from where it was measured, by linear interpolation.
double tilt_factor(const PhotometricFile& file, double angle_deg);

// ANSI/IES LM-63-1986 to -2019. bad_input: names file, line, field, value and range. TILT may name a file beside it.
Result<PhotometricFile> read_ies(const std::filesystem::path& file);
Result<PhotometricFile> parse_ies(std::string_view text, const std::filesystem::path& file);

// EULUMDAT (.ldt), Stockmar 1990. The first set of lamps counts; others are remarked on.
Result<PhotometricFile> read_eulumdat(const std::filesystem::path& file);
Result<PhotometricFile> parse_eulumdat(std::string_view text, const std::string& file);

// By the file's ending: .ies, .ldt or .eulumdat; else by what its first line says.
Result<PhotometricFile> read_photometric_file(const std::filesystem::path& file);

// The far field as LM-63-2002 with absolute photometry, all planes, for other tools. Written whole or not at all.
Status write_ies(const std::filesystem::path& file, const PhotometricFile& lamp);

}  // namespace lightwell
