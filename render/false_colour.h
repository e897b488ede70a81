// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/look.h"

namespace lightwell::render {

using Rgb8 = std::array<std::uint8_t, 3>;

// Colours of luminance on a logarithmic scale: cd/m² from 10⁻² to 10⁶ in a continuous scale, or stops from middle grey,
// from −8 to 8, each stop in one colour: grey at 0, colder below, warmer above.
struct FalseColourScale {
  FalseColour kind = FalseColour::luminance;

  // Bounds as binary logarithms of cd/m², or stops.
  [[nodiscard]] double low() const;
  [[nodiscard]] double high() const;
  // value: binary logarithm of cd/m², or stops; beyond the bounds black and white.
  [[nodiscard]] Rgb8 colour(double value) const;
  // count colours from low to high, each at the middle of its share.
  [[nodiscard]] std::vector<Rgb8> table(int count) const;
};

// RGBA, row 0 at the top: a bar of the scale with its numbers.
struct Legend {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;
};
// As large as a picture of this height allows; empty where numbers could not be read.
Legend make_legend(const FalseColourScale& scale, int picture_height);

}  // namespace lightwell::render
