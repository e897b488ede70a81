// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "render/gltf_values.h"
#include "render/scene.h"

namespace lightwell::render::gltf {

// A primitive as the file has it.
struct MeshFromFile {
  Shape shape;                                       // without its place in the scene, joints and weights
  std::vector<Vec2f> uvs;                            // or none
  std::vector<std::array<std::uint16_t, 4>> colors;  // or none
  std::vector<std::uint32_t> triangles;              // three corners each
};

// nullptr: triangles, in one of glTF's three modes; else what it is.
const char* mode_without_triangles(int mode);

// The set of coordinates uv_set is read if it is there.
MeshFromFile read_mesh(const tinygltf::Model& model, const tinygltf::Primitive& source, int uv_set,
                       const std::string& what);

}  // namespace lightwell::render::gltf
