// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/command.h"
#include "lighting/vector.h"

namespace lightwell::cli {

// "X,Y,Z" of --gravity as the zenith in the camera's frame. usage where it is not three finite numbers, or none that a
// sensor at rest reads (lighting/orientation.h).
Result<Vec3d> zenith_of_option(const std::string& text);

inline constexpr const char* kGravityHelp =
    "What an accelerometer at rest reads in the camera's frame: x right and y down in the image, z along the "
    "lens; "
    "any unit. 0,0,9.8 looks straight up";

}  // namespace lightwell::cli
