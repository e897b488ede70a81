// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <initializer_list>

#include "lighting/result.h"

namespace lightwell {

// usage where the output is a regular file that is also one of the inputs, by whatever name or link.
Status check_output_is_no_input(const std::filesystem::path& output,
                                std::initializer_list<std::filesystem::path> inputs);

// Whether two names of files to write, which need not be there, are one regular file or will be. Empty names are none.
bool is_one_output(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace lightwell
