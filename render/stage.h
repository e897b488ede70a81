// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace lightwell::render {

// The demo stage as glTF 2.0 text with its data inside: a ground that only receives shadows, a pearl, a knot
// on a pedestal and a railing of thin bars, 16,194 triangles, camera "stage". Metres.
std::string stage_gltf();

}  // namespace lightwell::render
