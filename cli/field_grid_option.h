// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lighting/field/field_grid.h"
#include "lighting/result.h"

namespace lightwell::cli {

// --grid NX,NY,NZ and --bounds X0,Y0,Z0,X1,Y1,Z1. usage: names the option, what was given and what is allowed.
Result<FieldGrid> field_grid(const std::string& size, const std::string& bounds);

}  // namespace lightwell::cli
