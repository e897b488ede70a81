// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

#include "interface/json_fields.h"
#include "lighting/response.h"
#include "lighting/vector.h"

// The content of response.json (docs/conventions.md) as JSON values, for those who add to it: calibrate response puts
// its report beside the model. Readers throw FieldFailure.
namespace lightwell {

// "log", "linear", "linlog", "pwl"
std::string_view model_name(const Response& response);

// The table is for other programs: the model says all.
nlohmann::json response_to_json(const Response& response, bool with_table);
Response response_from_json(const JsonFields& fields);

// The colour matrix stands in response.json, because it belongs to the sensor too; a monochrome camera has none, which
// is the identity.
void add_colour_matrix(nlohmann::json& response, const Eigen::Matrix3d& rec709_from_camera);
// object: the one that `fields` reads
Eigen::Matrix3d colour_matrix_from(const JsonFields& fields, const nlohmann::json& object);

}  // namespace lightwell
