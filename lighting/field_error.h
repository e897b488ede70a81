// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

#include "lighting/result.h"

namespace lightwell {

// bad_input in the house's one line: "lens.focal[0] = -3: allowed > 0". Whoever knows the file puts it in
// front.
inline Error field_error(std::string_view field, double value, std::string_view allowed) {
  char number[32];
  std::snprintf(number, sizeof number, "%.9g", value);
  return {ErrorKind::bad_input, std::string(field) + " = " + number + ": allowed " + std::string(allowed)};
}

}  // namespace lightwell
