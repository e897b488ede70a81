// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "interface/json_fields.h"
#include "lighting/lens.h"

// The content of lens.json (docs/conventions.md) as JSON values, for those who add to it. The reader throws
// FieldFailure.
namespace lightwell {

nlohmann::json lens_to_json(const Lens& lens);
Lens lens_from_json(const JsonFields& fields);

}  // namespace lightwell
