// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "render/gl_objects.h"
#include "render/light_rows.h"

namespace lightwell::render {

// Lights by region of the surface's normal, found through a cube map (Havran 2005, section 4.1). A cell of the cube lists the
// lights that reach some normal in it, in the lights' order: what is left out adds nothing, so a picture with lists is the
// one without.
//
// A cell's row of the table: how many lights; how many of them strong; of each subset of the weak ones (light_subsets.h) where
// it begins among the grouped, and where the last one ends; from kListed on all lights, from kGrouped on the weak ones
// subset by subset.
class LightLists {
 public:
  static constexpr int kSide = 8;  // cells a side of each of the cube's six faces
  static constexpr int kCells = 6 * kSide * kSide;
  static constexpr int kMostSubsets = 16;
  static constexpr int kListed = 2 + kMostSubsets + 1;
  static constexpr int kGrouped = kListed + kMaxLightsPerBlock;
  static constexpr int kColumns = kGrouped + kMaxLightsPerBlock;

  // rows: at most kMaxLightsPerBlock, the first `strong` of them strong; subsets: 1 to kMostSubsets. [kCells][kColumns]
  static std::vector<std::uint16_t> table(std::span<const LightRow> rows, std::size_t strong, int subsets);
  // The cell that a normal lies in; light_lists.glsl has the same.
  static int cell_of(const Vec3f& normal);
  // For the shader that reads them.
  static std::string facts();

  // Nothing to do where the lights stand.
  void set(std::span<const LightRow> rows, std::size_t strong, int subsets);
  [[nodiscard]] GLuint texture() const { return texture_.id(); }

 private:
  gl::Texture texture_;
  std::vector<std::array<float, 3>> listed_;  // directions that the texture lists
  std::size_t strong_ = 0;
  int subsets_ = 0;
};

}  // namespace lightwell::render
