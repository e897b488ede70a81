// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/field_layout.h"

#include <algorithm>

namespace lightwell::render {

bool takes_part_in_irradiance(int harmonic) {
  int l = 0;
  while (harmonic_count(l) <= harmonic) ++l;
  return irradiance_factor(l) != 0;
}

Result<FieldLayout> FieldLayout::create(const FieldGrid& grid, int degree, int main_lights,
                                        int texture_side) {
  FieldLayout layout;
  layout.grid_ = grid;
  layout.degree_ = degree;
  layout.main_lights_ = main_lights;
  const int harmonics = harmonic_count(degree);
  for (int h = 0; h < harmonics; ++h)
    if (takes_part_in_irradiance(h)) layout.triples_.push_back(h);
  for (int i = 0; i < main_lights; ++i) layout.triples_.push_back(harmonics + i);
  for (int h = 0; h < harmonics; ++h)
    if (!takes_part_in_irradiance(h)) layout.triples_.push_back(h);
  const auto too_large = [&] {
    return Error{ErrorKind::bad_input,
                 "a field of " + std::to_string(grid.size[0]) + " x " + std::to_string(grid.size[1]) + " x " +
                     std::to_string(grid.size[2]) + " points, degree " + std::to_string(degree) +
                     ": does not fit into " + std::to_string(kMostTextures) +
                     " 3D textures of this driver's " + std::to_string(texture_side) + " a side"};
  };
  // As many tiles along each axis as are needed, z first, where texels that follow each other lie far apart anyway.
  int needed = layout.texels();
  for (const std::size_t axis : {2u, 1u, 0u}) {
    const int fit = texture_side / grid.size[axis];
    if (fit < 1) return too_large();
    layout.tiles_[axis] = std::min(fit, needed);
    needed = (needed + layout.tiles_[axis] - 1) / layout.tiles_[axis];
  }
  layout.textures_ = needed;
  if (needed > kMostTextures) return too_large();
  return layout;
}

std::array<int, 3> FieldLayout::texture_size() const {
  return {grid_.size[0] * tiles_[0], grid_.size[1] * tiles_[1], grid_.size[2] * tiles_[2]};
}

std::size_t FieldLayout::bytes() const {
  return grid_.points() * static_cast<std::size_t>(tiles_[0] * tiles_[1] * tiles_[2] * textures_) * 8;
}

FieldLayout::Tile FieldLayout::tile(int texel) const {
  const int a_texture = tiles_[0] * tiles_[1] * tiles_[2];
  const int of_texture = texel % a_texture;
  return {texel / a_texture,
          {of_texture / (tiles_[2] * tiles_[1]) * grid_.size[0],
           of_texture / tiles_[2] % tiles_[1] * grid_.size[1], of_texture % tiles_[2] * grid_.size[2]}};
}

}  // namespace lightwell::render
