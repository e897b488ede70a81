// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "lighting/result.h"

namespace lightwell::render {

// Text of render/shaders/<name>, built into the program.
std::string_view shader_text(std::string_view name);

}  // namespace lightwell::render
