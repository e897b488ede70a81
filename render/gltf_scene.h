// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "lighting/result.h"
#include "render/scene.h"

namespace lightwell::render {

// glTF 2.0, .gltf or .glb: triangles of the default scene with their transforms, materials, images,
// perspective cameras. Triangle lists, strips and fans; missing normals become flat ones; triangles of no
// area are dropped and counted, primitives of points or lines are left out and named. extras.phong is read from the material, else the primitive, mesh or node;
// extras.lightwell.casts_shadow from the node (its children inherit it). Skins, morph targets, animation,
// normal maps, emission and transparency are not drawn. bad_input: missing, a directory, truncated,
// malformed, a buffer or image that is missing, indices or values out of range, NaN, required extensions, no
// triangles.
Result<Scene> read_gltf(const std::filesystem::path& file);

}  // namespace lightwell::render
