// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "render/scene.h"

// What programs that shade surfaces are compiled for, as text before a shader.
namespace lightwell::render {

// Which models the scene's materials use: only these are compiled.
struct MaterialKinds {
  bool phong = false;
  bool metallic_roughness = false;
  bool lobes = false;  // a Phong material with a specular part, or a metallic–roughness one
  bool emission = false;
  // HAS_PHONG, HAS_METALLIC_ROUGHNESS, HAS_LOBES, HAS_EMISSION.
  [[nodiscard]] std::string facts() const;
};
MaterialKinds material_kinds(const Scene& scene);

struct ShadowLookUp {
  bool simplified_casters = true;  // in the shadow maps
  // Edges of shadows as wide as their lights make them; else as sharp as the maps are.
  bool soft_edges = true;
};
// HAS_SHADOWS, and with it shadow.glsl and what it is to know.
std::string shadow_look_up(bool nothing_casts, const ShadowLookUp& options);

// surface.glsl: what the G-buffer shows at a pixel.
std::string surface_code();
// After it, reflectance.glsl: what the surface returns of a light.
std::string reflectance_code();
// shadow_texels.glsl: look-ups in tiles of depths; part of shadow_look_up().
std::string shadow_texel_code();

}  // namespace lightwell::render
