// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "lighting/result.h"

namespace lightwell {

// failed where write_file_atomically could not begin: asked before long work rather than after it. A device or pipe is
// not opened.
Status check_can_write(const std::filesystem::path& file);

}  // namespace lightwell
