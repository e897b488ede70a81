// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "render/gl_objects.h"
#include "render/shading_facts.h"

namespace lightwell::render {

// The lobes of a scene's materials (lighting/field/surface_lobes.h) as an array of textures of half floats, linear: columns by the
// material's number, rows by the cosine to the eye. An entry fills the channels of layers that follow each other: how far the
// axis is toward the normal, then the bands; metallic–roughness goes on with those of edge and below.
class LobeTables {
 public:
  // The same again does nothing.
  void make(const MaterialKinds& kinds, int degree);
  // Facts of the shader; empty where there are no lobes.
  [[nodiscard]] std::string facts() const;
  void bind(int unit) const;

 private:
  int degree_ = 0;
  int layers_ = 0;       // of an entry
  int rough_layer_ = 0;  // where metallic–roughness begins
  gl::Texture texture_;
};

}  // namespace lightwell::render
