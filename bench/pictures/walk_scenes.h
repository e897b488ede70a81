// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace lightwell::pictures {

// What stands on the stage of the simulated walk (daemon/simulator/walk_stage.h), glTF text. Metres.
std::string walk_ground_gltf();  // its ground alone, from above
std::string walk_set_gltf();     // with a few things on it, as a camera in front sees them

}  // namespace lightwell::pictures
