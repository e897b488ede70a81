// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lighting/polar_map.h"

namespace lightwell::bench {

struct NamedMap {
  std::string name;
  PolarMap map;
};

// The upper hemispheres of the folder's latitude–longitude images (EXR, Radiance HDR), at 90 × 360, in order of
// name; without test patterns (names with Orientation, Cube, spot1Lux) and what cannot be read.
std::vector<NamedMap> real_maps(const std::filesystem::path& folder);

// Four painted ones: a sky, the same with a sun, a room, a room at night with many lamps.
std::vector<NamedMap> painted_maps();

}  // namespace lightwell::bench
