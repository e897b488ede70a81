// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "lighting/vector.h"

// Penrose's rhombus tiling as a hierarchy of Robinson triangles (half rhombi), whose vertices carry ranks in the
// Fibonacci number system. source: Ostromoukhov, Donohue and Jodoin 2004; Robinson 1975
//
// A code is a string of binary digits without two adjacent ones; the digit at place k (0: the last) counts
// F(k + 2), so the codes of m digits are the numbers below F(m + 2). A thin half rhombus has a code that begins
// with 1, a thick one a code that begins with 0. Subdivision by the golden section puts two digits in front of
// the code w of the parent:
//   thin  → thin 10w, thick 00w;             new vertex 10w on the divided edge
//   thick → thick 00w, thick 01w, thin 10w;  new vertices 10w on the divided edge, 01w on the long diagonal
// so no code comes twice, none is left out, and a vertex keeps its number for ever (00 in front changes
// nothing). Hence the vertices of rank below x are spread evenly over the plane with a density in proportion
// to x, for every x. An edge lies between two halves of opposite handedness; the left one counts its vertices.
namespace lightwell {

std::int64_t fibonacci(int n);  // F(1) = F(2) = 1; n: 1 to 90

struct RobinsonTriangle {
  enum class Rhombus { thin, thick } rhombus = Rhombus::thin;
  bool left = true;
  Vec2d apex, b, c;  // the apex between the two equal sides; apex–b is the edge that is divided
  std::int64_t code = 1;
  int digits = 1;

  // No vertex that subdividing brings forth, at any depth, has a lower rank.
  [[nodiscard]] std::int64_t least_rank() const;
};

struct TilingVertex {
  Vec2d place;
  std::int64_t rank = 0;
};

struct Subdivision {
  std::array<RobinsonTriangle, 3> triangle;
  std::array<TilingVertex, 2> vertex;
  int triangles = 0;
  int vertices = 0;  // those that this triangle counts: none where it is a right one

  [[nodiscard]] std::span<const RobinsonTriangle> children() const {
    return std::span(triangle).first(static_cast<std::size_t>(triangles));
  }
  [[nodiscard]] std::span<const TilingVertex> new_vertices() const {
    return std::span(vertex).first(static_cast<std::size_t>(vertices));
  }
};

inline constexpr int kMostDigits = 85;  // of a triangle to divide: beyond, ranks leave 63 bits

Subdivision subdivide(const RobinsonTriangle& triangle);

// A thin half rhombus, left-handed, about the unit disc, turned by an angle.
RobinsonTriangle triangle_around_unit_disc(double turn_rad);

}  // namespace lightwell
