// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "lighting/vector.h"

namespace lightwell::render {

// No point of these triangles (three corners each, which index positions) is farther than distance_m from a surface. May
// say no where the truth is just below distance_m; never yes where it is above.
bool lies_within(std::span<const std::uint32_t> triangles, std::span<const std::uint32_t> of,
                 std::span<const Vec3f> positions, double distance_m);

// Either surface from the other: their Hausdorff distance.
bool stay_together(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b,
                   std::span<const Vec3f> positions, double distance_m);

}  // namespace lightwell::render
