// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/lobe_tables.h"

#include <vector>

#include "lighting/field/surface_lobes.h"

namespace lightwell::render {
namespace {

std::vector<double> numbers_of(const SurfaceLobe& entry, int degree) {
  const auto bands = static_cast<std::ptrdiff_t>(degree) + 1;
  std::vector<double> numbers = {entry.lobe.toward_normal};
  for (const auto* part : {&entry.lobe.bands, &entry.edge, &entry.below})
    numbers.insert(numbers.end(), part->begin(), part->begin() + bands);
  return numbers;
}

void upload(const std::vector<SurfaceLobe>& table, int degree, int first_layer, int layers) {
  std::vector<Eigen::half> texels(table.size() * 4);
  for (int layer = 0; layer < layers; ++layer) {
    for (std::size_t i = 0; i < table.size(); ++i) {
      const auto numbers = numbers_of(table[i], degree);
      for (std::size_t c = 0; c < 4; ++c) {
        const std::size_t at = 4 * static_cast<std::size_t>(layer) + c;
        texels[4 * i + c] = Eigen::half(at < numbers.size() ? static_cast<float>(numbers[at]) : 0.0f);
      }
    }
    glTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, 0, 0, first_layer + layer, kLobeSteps, kLobeSteps, 1, GL_RGBA,
                    GL_HALF_FLOAT, texels.data());
  }
}

}  // namespace

void LobeTables::make(const MaterialKinds& kinds, int degree) {
  if (!kinds.lobes || degree == degree_) return;
  degree_ = degree;
  const int numbers = 1 + (kinds.metallic_roughness ? 3 : 1) * (degree + 1);
  layers_ = (numbers + 3) / 4;
  rough_layer_ = kinds.phong ? layers_ : 0;
  GLuint id = 0;
  glGenTextures(1, &id);
  texture_ = gl::Texture(id);
  glBindTexture(GL_TEXTURE_2D_ARRAY, id);
  glTexStorage3D(GL_TEXTURE_2D_ARRAY, 1, GL_RGBA16F, kLobeSteps, kLobeSteps,
                 layers_ * (kinds.phong && kinds.metallic_roughness ? 2 : 1));
  for (const GLenum filter : {GLenum{GL_TEXTURE_MIN_FILTER}, GLenum{GL_TEXTURE_MAG_FILTER}})
    glTexParameteri(GL_TEXTURE_2D_ARRAY, filter, GL_LINEAR);
  for (const GLenum wrap : {GLenum{GL_TEXTURE_WRAP_S}, GLenum{GL_TEXTURE_WRAP_T}})
    glTexParameteri(GL_TEXTURE_2D_ARRAY, wrap, GL_CLAMP_TO_EDGE);
  if (kinds.phong) upload(phong_table(degree), degree, 0, layers_);
  if (kinds.metallic_roughness) upload(roughness_table(degree), degree, rough_layer_, layers_);
}

std::string LobeTables::facts() const {
  if (texture_.id() == 0) return "";
  return "#define LOBE_LAYERS " + std::to_string(layers_) + "\n#define ROUGH_LAYER " +
         std::to_string(rough_layer_) + ".0\n#define LOBE_STEPS " + std::to_string(kLobeSteps) +
         ".0\n#define EXPONENT_MIDDLE " + std::to_string(kExponentMiddle) + "\n";
}

void LobeTables::bind(int unit) const {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_2D_ARRAY, texture_.id());
}

}  // namespace lightwell::render
