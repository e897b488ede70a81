// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "lighting/lens.h"

namespace lightwell::calibration {

// The last part of a picture's path: pages are handed on, folders are nobody's business.
std::string file_name(const std::string& path);

// Residuals as arrows from where a picture shows a point to where the lens puts it: of all views in one picture, then of
// the six views used with the largest rms, one each. views: as lens.json has them; throws nlohmann::json::exception where they are not.
std::string residual_plots(const Lens& lens, const nlohmann::json& views);

}  // namespace lightwell::calibration
