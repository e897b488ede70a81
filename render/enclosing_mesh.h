// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "render/scene.h"

namespace lightwell::render {

// A primitive that casts shadows, has no holes and encloses a point of the world: four rays from there all leave it through
// its triangles' backs. nullopt: none does, as where the point is in a room whose walls face it.
std::optional<std::size_t> enclosing_mesh(const Scene& scene, const Vec3d& point);

}  // namespace lightwell::render
