// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "render/picture.h"

namespace lightwell::render {

// Writes lightwell-NNNN.png and .exr into a folder, under the first number from 1 of which neither is there; returns
// the names without the folder's. failed: the folder or the disk, or all 9999 are there.
Result<std::string> write_screenshot(const std::filesystem::path& folder, const DisplayPicture& display,
                                     const RadiancePicture& radiance);

}  // namespace lightwell::render
