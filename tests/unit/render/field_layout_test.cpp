// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/field_layout.h"

#include <gtest/gtest.h>

#include <set>

namespace lightwell::render {
namespace {

FieldGrid grid_of(int x, int y, int z) {
  return {{x, y, z}, Vec3d::Zero(), Vec3d::Ones()};
}

// 256 is what every OpenGL ES 3.1 takes.
TEST(FieldLayout, EveryTexelHasATileOfItsOwnInsideATexture) {
  for (const auto& grid : {grid_of(2, 2, 2), grid_of(64, 64, 64), grid_of(100, 20, 256), grid_of(85, 86, 3)})
    for (const int degree : {1, 4, 8}) {
      const auto layout = FieldLayout::create(grid, degree, 4, 256);
      if (!layout) {
        EXPECT_GT(grid.points(), 100u * 20 * 200);
        continue;
      }
      EXPECT_EQ(layout->triples().size(), static_cast<std::size_t>(harmonic_count(degree)) + 4);
      std::set<std::pair<int, std::array<int, 3>>> corners;
      const auto size = layout->texture_size();
      for (int i = 0; i < layout->texels(); ++i) {
        const FieldLayout::Tile tile = layout->tile(i);
        EXPECT_LT(tile.texture, layout->textures());
        for (std::size_t a = 0; a < 3; ++a) {
          EXPECT_EQ(tile.corner[a] % grid.size[a], 0);
          EXPECT_LE(tile.corner[a] + grid.size[a], size[a]);
          EXPECT_LE(size[a], 256);
        }
        corners.insert({tile.texture, tile.corner});
      }
      EXPECT_EQ(corners.size(), static_cast<std::size_t>(layout->texels()));
    }
}

TEST(FieldLayout, DegreeFourOf64CubedIsOneTextureOfTwoDozenTiles) {
  const auto layout = FieldLayout::create(grid_of(64, 64, 64), 4, 4, 2048);
  ASSERT_TRUE(layout.ok());
  EXPECT_EQ(layout->texels(), 22);  // 25 harmonics and 4 lights, three numbers each
  EXPECT_EQ(layout->textures(), 1);
  EXPECT_EQ(layout->bytes(), 22u * 64 * 64 * 64 * 8);
}

TEST(FieldLayout, WhatTheDriverDoesNotHoldIsRefusedWithItsNumbers) {
  const auto layout = FieldLayout::create(grid_of(256, 256, 256), 4, 0, 256);
  ASSERT_FALSE(layout.ok());
  EXPECT_EQ(layout.error().kind, ErrorKind::bad_input);
  EXPECT_NE(layout.error().message.find("256 x 256 x 256"), std::string::npos) << layout.error().message;
  EXPECT_FALSE(FieldLayout::create(grid_of(300, 2, 2), 1, 0, 256).ok());
}

}  // namespace
}  // namespace lightwell::render
