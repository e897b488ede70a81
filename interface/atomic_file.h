// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include <filesystem>
#include <string>
#include <string_view>

#include "lighting/result.h"

namespace lightwell {

// Writes a file whole or not at all: temporary file beside it, fsync, rename. Kind failed with the reason and path.
Status write_file_atomically(const std::filesystem::path& file, std::string_view content);

// Whole file as text; bad_input for missing, directory, unreadable, larger than limit_bytes.
Result<std::string> read_text_file(const std::filesystem::path& file, std::size_t limit_bytes = 256u << 20);

}  // namespace lightwell
