// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "lighting/result.h"

namespace lightwell {

inline constexpr const char* kTakeNameRule =
    "letters, digits, '.', '_', '-' and spaces, not only spaces, no leading '.' or '-', ends in .mkv, 128 at "
    "most";

// Whether a take may have this name inside the record directory, where anybody on this machine may ask for
// one: a plain name that no shell, terminal or file system takes for more (interface/openapi.yaml). usage,
// naming what is wrong and allowed.
Status check_take_name(const std::string& file);

// The name of a take that nobody named, by its beginning: "take 2026-11-22 14.05.09.mkv", UTC.
std::string take_name_at(std::int64_t utc_ns);

}  // namespace lightwell
