// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/field_textures.h"

#include <algorithm>
#include <cmath>

namespace lightwell::render {
namespace {

gl::Texture make_volume(const std::array<int, 3>& size) {
  GLuint id = 0;
  glGenTextures(1, &id);
  glBindTexture(GL_TEXTURE_3D, id);
  glTexStorage3D(GL_TEXTURE_3D, 1, GL_RGBA16F, size[0], size[1], size[2]);
  for (const GLenum filter : {GLenum{GL_TEXTURE_MIN_FILTER}, GLenum{GL_TEXTURE_MAG_FILTER}})
    glTexParameteri(GL_TEXTURE_3D, filter, GL_LINEAR);
  for (const GLenum wrap : {GLenum{GL_TEXTURE_WRAP_S}, GLenum{GL_TEXTURE_WRAP_T}, GLenum{GL_TEXTURE_WRAP_R}})
    glTexParameteri(GL_TEXTURE_3D, wrap, GL_CLAMP_TO_EDGE);
  return gl::Texture(id);
}

// Half floats have eleven digits from 6e-5 to 65504: the largest number comes to 2^14 at most, so that what is a hundred
// millionth of it still keeps its digits. The power of two keeps a reciprocal, however dark the field.
float scale_of(const LightField& field, const MainLights& lights) {
  float most = 0;
  for (const float value : field.radiance) most = std::max(most, std::abs(value));
  for (const float value : lights.illuminance) most = std::max(most, value);
  return most > 0 ? std::exp2(std::max(std::ceil(std::log2(most)) - 14, -120.0f)) : 1.0f;
}

}  // namespace

void FieldTextures::set_layout(const FieldLayout& layout) {
  if (layout == layout_) return;
  layout_ = layout;
  textures_.clear();
}

void FieldTextures::fill(const LightField& field, const MainLights& lights) {
  while (static_cast<int>(textures_.size()) < layout_.textures())
    textures_.push_back(make_volume(layout_.texture_size()));
  scale_ = scale_of(field, lights);
  const float inverse = 1 / scale_;
  const auto& size = layout_.grid().size;
  const std::size_t slab = field.slab_points();
  const int harmonics = field.harmonics();
  const auto& triples = layout_.triples();
  // Rounded here: drivers may cut.
  std::vector<Eigen::half> texels(4 * slab * static_cast<std::size_t>(size[2]));
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  for (int t = 0; t < layout_.texels(); ++t) {
    for (std::size_t c = 0; c < 4; ++c) {
      const std::size_t at = static_cast<std::size_t>(t) * 4 + c;
      for (int z = 0; z < size[2]; ++z) {
        Eigen::half* out = &texels[4 * slab * static_cast<std::size_t>(z) + c];
        if (at >= 3 * triples.size()) {
          for (std::size_t i = 0; i < slab; ++i) out[4 * i] = Eigen::half(0);
          continue;
        }
        const int triple = triples[at / 3];
        const auto channel = static_cast<int>(at % 3);
        const float* in = triple < harmonics ? field.plane(z, triple, channel)
                                             : lights.plane(triple - harmonics, z, channel, field.grid);
        for (std::size_t i = 0; i < slab; ++i) out[4 * i] = Eigen::half(in[i] * inverse);
      }
    }
    const FieldLayout::Tile tile = layout_.tile(t);
    glBindTexture(GL_TEXTURE_3D, textures_[static_cast<std::size_t>(tile.texture)].id());
    glTexSubImage3D(GL_TEXTURE_3D, 0, tile.corner[0], tile.corner[1], tile.corner[2], size[0], size[1],
                    size[2], GL_RGBA, GL_HALF_FLOAT, texels.data());
  }
}

void FieldTextures::bind(int first_unit) const {
  for (std::size_t i = 0; i < textures_.size(); ++i) {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(first_unit) + static_cast<GLenum>(i));
    glBindTexture(GL_TEXTURE_3D, textures_[i].id());
  }
}

}  // namespace lightwell::render
