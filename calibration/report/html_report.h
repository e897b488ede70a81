// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "lighting/calibration.h"
#include "lighting/result.h"

namespace lightwell::calibration {

// What one file of a calibration has to say: a part of the verdict ("good to 4 % from 0.02 to 2e5 cd/m2"), a warning
// where there is one, and HTML with inline SVG.
struct ReportSection {
  std::string verdict, warning, html;
};
ReportSection response_section(const Response& response, const nlohmann::json& file);
ReportSection lens_section(const Lens& lens, const nlohmann::json& file);
ReportSection flat_section(const FlatField& flat, double max_theta_rad, const nlohmann::json& file);

// One self-contained page about the response.json, lens.json and flat.json of a folder, as many as there are: no
// scripts, nothing loaded. bad_input: none of them is there, or one cannot be read.
Result<std::string> calibration_page(const std::filesystem::path& directory);

}  // namespace lightwell::calibration
