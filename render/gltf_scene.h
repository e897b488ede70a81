// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "lighting/result.h"
#include "render/scene.h"

namespace lightwell::render {

// glTF 2.0, .gltf or .glb: triangles of the default scene with their transforms, materials, images,
// perspective cameras, and how they move: animated nodes, skins, morph targets. The scene stands at the
// animation's time 0. Triangle lists, strips and fans; missing normals become flat ones; triangles of no area
// are dropped and counted, primitives of points or lines are left out and named, what else is not shown as the
// file says is in remarks. extras.phong is read from the material, else the primitive, mesh or node;
// extras.lightwell.casts_shadow from the node (its children inherit it).
// animation: its name; empty: the first.
// bad_input: missing, a directory, truncated, malformed, a buffer or image that is missing, indices or values
// out of range, NaN, required extensions, no triangles, more than 10⁸. usage: no animation of that name.
// failed: no memory.
Result<Scene> read_gltf(const std::filesystem::path& file, const std::string& animation = "");

}  // namespace lightwell::render
