// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "lighting/result.h"

namespace lightwell::cli {

// Before the work: usage where --out does not end as its format does (".exr", ".ies") or is one of the inputs; failed where it cannot be
// written. Devices and pipes may have any name.
Status check_luminaire_output(const std::string& out, const std::string& ending,
                              std::span<const std::string> inputs);

}  // namespace lightwell::cli
