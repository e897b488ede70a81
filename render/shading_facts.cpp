// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/shading_facts.h"

#include <algorithm>

#include "render/casters.h"
#include "render/shaders.h"

namespace lightwell::render {
namespace {

std::string fact(const char* name, bool holds) {
  return std::string("#define ") + name + (holds ? " 1\n" : " 0\n");
}

}  // namespace

MaterialKinds material_kinds(const Scene& scene) {
  MaterialKinds kinds;
  for (const Material& m : scene.materials) {
    const bool phong = m.model == Material::Model::phong;
    (phong ? kinds.phong : kinds.metallic_roughness) = true;
    kinds.lobes = kinds.lobes || !phong || (m.specular > 0).any();
  }
  kinds.emission = std::any_of(scene.primitives.begin(), scene.primitives.end(), [&](const Primitive& p) {
    return (scene.materials[static_cast<std::size_t>(p.material)].emission > 0).any();
  });
  return kinds;
}

std::string MaterialKinds::facts() const {
  return fact("HAS_PHONG", phong) + fact("HAS_METALLIC_ROUGHNESS", metallic_roughness) +
         fact("HAS_LOBES", lobes) + fact("HAS_EMISSION", emission);
}

std::string shadow_look_up(bool nothing_casts, const ShadowLookUp& options) {
  constexpr float kCurvatureTexels = 0.1f;
  if (nothing_casts) return fact("HAS_SHADOWS", false);
  // Depth: two steps of 16 bits. Cosine: below it the plane's slope is cut, where little light falls anyway.
  return fact("HAS_SHADOWS", true) + "#define CASTER_SLACK " +
         std::to_string(kCurvatureTexels + (options.simplified_casters ? kSimplifiedTexels : 0)) +
         "\n#define DEPTH_SLACK 0.00003\n#define LEAST_COSINE 0.05\n" +
         fact("SOFT_EDGES", options.soft_edges) + shadow_texel_code() +
         std::string(shader_text("shadow.glsl"));
}

std::string shadow_texel_code() {
  return std::string(shader_text("shadow_texels.glsl"));
}

std::string surface_code() {
  return std::string(shader_text("surface.glsl"));
}

std::string reflectance_code() {
  return std::string(shader_text("reflectance.glsl"));
}

}  // namespace lightwell::render
