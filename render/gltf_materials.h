// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "render/gltf_values.h"
#include "render/scene.h"

namespace lightwell::render::gltf {

std::vector<TextureImage> read_textures(const tinygltf::Model& model);

struct MaterialFromFile {
  Material material;
  int uv_set = 0;  // TEXCOORD_n of all its textures
};
// remarks gets what of it is not shown.
MaterialFromFile read_material(const tinygltf::Model& model, std::size_t index,
                               std::vector<std::string>& remarks);

// True where extras carries a Phong model, which m becomes.
bool apply_phong(const tinygltf::Value& extras, const std::string& what, Material& m);

// BadScene: an extension is required that is not supported. remarks gets those that are used and passed by.
void check_extensions(const tinygltf::Model& model, std::vector<std::string>& remarks);

}  // namespace lightwell::render::gltf
