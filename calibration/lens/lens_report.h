// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calibration/lens/lens_calibration.h"

namespace lightwell::calibration {

// lens.json of a calibration: what the spine reads, and beside it covariance, errors, views, the uncertainty and the
// coverage over the field (docs/conventions.md).
nlohmann::ordered_json lens_report(const LensCalibration& calibration, const TargetViews& target_views);

// Why the lens is to be trusted less than its numbers say, a line each, for a person.
std::vector<std::string> lens_warnings(const LensCalibration& calibration);

// Where the field has no points, for a person: "60 to 70 degrees: sectors 0 to 30, 90 to 150"; empty where it has
// points everywhere.
std::string coverage_gaps(const LensCalibration& calibration, const TargetViews& target_views);

}  // namespace lightwell::calibration
