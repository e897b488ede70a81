// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lighting/luminaire/luminaire.h"

namespace lightwell::render {

// What the pixels of a source's image stand for.
enum class SourceMap {
  plane,       // tangents x / −z and y / −z of directions with z < 0
  hemisphere,  // directions with z < 0 on a square (square_from_direction)
  sphere,  // all directions: columns by photometric C, which goes round, nodes of rows by γ from 0 to 180°
};

// A part of a lamp as the renderer draws it: points, each with an image of the luminous intensity, cd, that it sends into
// every direction. In the lamp's frame.
struct LampSources {
  SourceMap map = SourceMap::plane;
  int width = 1, height = 1;        // of an image
  Vec2d span = Vec2d::Constant(2);  // plane: from edge to edge of an image, tangents
  struct Source {
    Vec3d place;
    Vec2d low = Vec2d::Constant(-1);  // plane: tangents at the first corner of its image
  };
  std::vector<Source> sources;
  double radius_m = 0;      // of the disc of lamp that a source stands for
  std::vector<Rgb> pixels;  // [source][row][column]

  [[nodiscard]] std::size_t image_size() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  [[nodiscard]] bool is_grey() const;
  [[nodiscard]] float brightest() const;  // of all channels, absolute
};

// The near field, with the light of `group` × `group` neighbouring positions taken together at the middle of its flux: into
// each direction the same light as before. Positions without light are left out.
LampSources sources_of(const NearField& lamp, int group);
// How many that are at the most.
std::size_t source_count(const NearField& lamp, int group);
// What a driver is asked to hold: layers of a texture, and rows of a block, that every driver has; texels of a lamp's images,
// 128 MB grey, 512 MB in colour.
inline constexpr std::size_t kMostSources = 256;
inline constexpr std::size_t kMostTexels = std::size_t{1} << 26;
// The positions a side that are taken together at least for that; 1: none need be.
int least_group(const NearField& lamp);
// One group of all positions.
int largest_group(const NearField& lamp);

// The far field, at the nodes of its table where their step is a whole part of a circle and a half, else at every half degree,
// in steps about as wide as high: nodes between the table's are its own linear interpolation. One source. centre: where it is
LampSources sources_of(const FarField& lamp, const Vec3d& centre);

// Flux of the positions' images, lm, in the order of LampPlanes::image.
std::vector<double> position_fluxes(const NearField& lamp);
// Where positions that are taken together stand.
struct LampGroups {
  std::vector<Vec2d> middles;         // on the sampling plane, by flux
  std::vector<double> fluxes;         // lm
  std::vector<std::size_t> group_of;  // of each position
};
// fluxes: position_fluxes()
LampGroups group_positions(const LampPlanes& planes, const std::vector<double>& fluxes, int group);

}  // namespace lightwell::render
