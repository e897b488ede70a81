// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lighting/vector.h"

// Meshes as shadow maps need them: three corners a triangle, which index welded positions.
namespace lightwell::render {

// Every edge is shared by two triangles that run along it in opposite directions.
bool is_closed(std::span<const std::uint32_t> triangles);

// No point of either surface is farther than distance_m from the other (their Hausdorff distance). May say no
// where the truth is just below distance_m; never yes where it is above.
bool stay_together(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b,
                   std::span<const Vec3f> positions, double distance_m);

// The same surface with fewer triangles, each connected piece by itself; the corners are among those given.
// max_distance_m: no point of either surface is farther from the other, so seen from anywhere no outline moves
// by more. A closed piece is held to a quarter of its volume over its surface besides, so that bars keep
// their thickness. Closed pieces stay closed, free borders stay where they are. A piece that cannot be had so
// stays as it is.
// source: Garland and Heckbert 1997, by meshoptimizer
std::vector<std::uint32_t> simplify(std::span<const std::uint32_t> triangles,
                                    std::span<const Vec3f> positions, float max_distance_m);

}  // namespace lightwell::render
