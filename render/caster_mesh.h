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

// The same surface with fewer triangles, each connected piece by itself; the corners are among those given.
// max_distance_m: no point of either surface is farther from the other, so seen from anywhere no outline moves
// by more. A closed piece is held to a quarter of its volume over its surface besides, so that bars keep
// their thickness. spent_m: how much of both is used up, where the triangles are simpler ones already.
// Closed pieces stay closed, large ones as every edge is run along as often in either direction, though more than two
// triangles may meet there. Free borders stay where they are. A piece that cannot be had so stays as it is.
// source: Garland and Heckbert 1997, by meshoptimizer
std::vector<std::uint32_t> simplify(std::span<const std::uint32_t> triangles,
                                    std::span<const Vec3f> positions, float max_distance_m,
                                    float spent_m = 0);

}  // namespace lightwell::render
