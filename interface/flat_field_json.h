// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "interface/json_fields.h"
#include "lighting/flat_field.h"

// The content of flat.json (docs/conventions.md) as JSON values, for those who add to it. The reader throws
// FieldFailure.
namespace lightwell {

nlohmann::json flat_field_to_json(const FlatField& flat);
FlatField flat_field_from_json(const JsonFields& fields);

// Values as a file holds them: what writing and reading back gives.
std::vector<float> as_stored(const std::vector<float>& values);

}  // namespace lightwell
