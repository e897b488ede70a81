// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace lightwell {

// The cameras libcamera sees, as a JSON array of {id, model, formats: [{name, pixel_format, raw, sizes}], controls:
// {name: range}}: what list_libcamera reads.
std::string list_cameras();

}  // namespace lightwell
