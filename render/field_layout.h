// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "lighting/field/light_field.h"
#include "lighting/result.h"

namespace lightwell::render {

// A_l of its band is not 0.
bool takes_part_in_irradiance(int harmonic);

// How a light field lies in 3D textures. A grid point has a triple R, G, B for each harmonic and for each main light; triples
// in a row fill the four channels of texels, and each texel of a point is in a tile, a copy of the grid, of a texture. Tiles
// need no border: what is looked up stays between the centres of a tile's outermost texels.
// First stand the harmonics that irradiance takes (bands 0, 1 and the even ones), then the main lights, then the others, so
// that a scene without gloss looks up fewer texels.
class FieldLayout {
 public:
  // texture_side: the driver's limit of 3D textures. bad_input where more than kMostTextures would be needed.
  static Result<FieldLayout> create(const FieldGrid& grid, int degree, int main_lights, int texture_side);

  static constexpr int kMostTextures =
      6;  // of the 16 units that OpenGL ES 3.1 guarantees, others are used for the rest
  [[nodiscard]] int degree() const { return degree_; }
  [[nodiscard]] int main_lights() const { return main_lights_; }
  [[nodiscard]] int textures() const { return textures_; }
  // Texels of one texture along x, y, z.
  [[nodiscard]] std::array<int, 3> texture_size() const;
  [[nodiscard]] std::size_t bytes() const;
  [[nodiscard]] const FieldGrid& grid() const { return grid_; }
  // What the triples stand for, in their order: a harmonic, or harmonic_count(degree) and up for a main light.
  [[nodiscard]] const std::vector<int>& triples() const { return triples_; }
  [[nodiscard]] int texels() const { return static_cast<int>(triples_.size() * 3 + 3) / 4; }  // of a point
  struct Tile {
    int texture = 0;
    std::array<int, 3> corner{};  // texels
  };
  [[nodiscard]] Tile tile(int texel) const;

  // GLSL: fetch_field(place) looks up what the others need; bands(d, b) gives the light of each band in a direction,
  // b[l] = Σ_m L_lm Y_lm(d), bands_of_irradiance(d, b) those that irradiance takes, the others 0; bands_of_light(cosine, b) what
  // they are for a light of illuminance 1 at that angle to d; light_here(i) is the illuminance of a main light; kIrradiance
  // holds A_l. place: the point's texel in the first tile, in texture coordinates. lobes: without them bands() is not there, and
  // the texels that it alone needs are not looked up. FIELD_TEXEL, where it is defined before, takes the look-up's place.
  [[nodiscard]] std::string code(bool lobes) const;

  bool operator==(const FieldLayout&) const = default;

 private:
  FieldGrid grid_;
  int degree_ = 0;
  int main_lights_ = 0;
  int textures_ = 0;
  std::array<int, 3> tiles_{};  // of one texture along x, y, z
  std::vector<int> triples_;
};

}  // namespace lightwell::render
