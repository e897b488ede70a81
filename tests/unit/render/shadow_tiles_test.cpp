// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/shadow_tiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace lightwell::render {
namespace {

constexpr int kPageLimit = 4096;

std::vector<LightRow> rows(unsigned seed, int count) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::lognormal_distribution<float> power(0, 1.5);
  std::vector<LightRow> made;
  for (int i = 0; i < count; ++i) {
    const Vec3f d = Vec3f(normal(random), std::abs(normal(random)) + 0.05f, normal(random)).normalized();
    LightRow row{};
    std::copy_n(d.data(), 3, row.to_light);
    row.extent_m = -2;
    std::fill_n(row.illuminance, 3, power(random));
    made.push_back(row);
  }
  return made;
}

// As if all were drawn, into a square of two metres.
void draw(ShadowTiles& tiles) {
  for (ShadowTile& tile : tiles.tiles()) {
    tile.row.texel = 1 / static_cast<float>(tile.side * tiles.unit());
    tile.row.fit[0] = tile.row.fit[1] = 0.5f;
    tile.stale = false;
  }
}

long stale(const ShadowTiles& tiles) {
  return std::count_if(tiles.tiles().begin(), tiles.tiles().end(),
                       [](const ShadowTile& t) { return t.stale; });
}

void expect_in_place(const ShadowTiles& tiles) {
  const int side = tiles.pages().side();
  EXPECT_LE(side * tiles.unit(), kPageLimit);
  EXPECT_LE(tiles.pages().count(), kMostPages);
  std::vector<char> taken(static_cast<std::size_t>(tiles.pages().count() * side * side), 0);
  int page = 0;
  for (const ShadowTile& tile : tiles.tiles()) {
    EXPECT_GE(tile.place.page, page) << "rows are in the order of their pages";
    page = tile.place.page;
    ASSERT_LE(tile.place.at.x + tile.side, side);
    ASSERT_LE(tile.place.at.y + tile.side, side);
    for (int y = tile.place.at.y; y < tile.place.at.y + tile.side; ++y)
      for (int x = tile.place.at.x; x < tile.place.at.x + tile.side; ++x) {
        char& there = taken[static_cast<std::size_t>((page * side + y) * side + x)];
        ASSERT_EQ(there, 0) << "two lights share texels";
        there = 1;
      }
  }
}

TEST(ShadowTiles, AThousandAndTwentyFourLightsOf256StandOnFourPages) {
  ShadowTiles tiles(256, true, kPageLimit);
  auto lights = rows(1, 1024);
  tiles.assign(lights);
  EXPECT_EQ(tiles.pages().count(), 4);
  EXPECT_EQ(stale(tiles), 1024);
  expect_in_place(tiles);
}

TEST(ShadowTiles, LightsThatStandKeepTheirTilesAtAnyCountAndInAnyOrder) {
  for (const int count : {1, 64, 255, 256, 257, 700, 1024}) {
    ShadowTiles tiles(256, true, kPageLimit);
    auto lights = rows(2, count);
    tiles.assign(lights);
    draw(tiles);
    std::shuffle(lights.begin(), lights.end(), std::mt19937(3));
    tiles.assign(lights);
    EXPECT_EQ(stale(tiles), 0) << count;
    expect_in_place(tiles);
  }
}

TEST(ShadowTiles, ATileIsItsRows) {
  ShadowTiles tiles(256, true, kPageLimit);
  auto lights = rows(4, 700);
  tiles.assign(lights);
  draw(tiles);
  tiles.assign(lights);
  for (std::size_t i = 0; i < lights.size(); ++i)
    EXPECT_TRUE(std::equal(lights[i].to_light, lights[i].to_light + 3, tiles.tiles()[i].row.to_light)) << i;
}

TEST(ShadowTiles, MoreLightsThanPagesHoldShareTheirTexels) {
  for (const int size : {256, 300, 1024}) {
    ShadowTiles tiles(size, true, kPageLimit);
    const int count = static_cast<int>(std::min<std::size_t>(tiles.capacity(), 5000));
    auto lights = rows(5, count);
    tiles.assign(lights);
    EXPECT_EQ(tiles.tiles().size(), static_cast<std::size_t>(count));
    expect_in_place(tiles);
  }
}

// 13 maps of 300 fill a side of 4096 and leave a gap: shares of power must give way, not fail.
TEST(ShadowTiles, SidesThatAreNoPowersOfTwoFit) {
  for (const int size : {30, 63, 300, 500, 1000, 4096}) {
    ShadowTiles tiles(size, true, kPageLimit);
    for (unsigned frame = 0; frame < 4; ++frame) {
      const auto count = std::min<std::size_t>(tiles.capacity(), 40u << frame);
      auto lights = rows(frame, static_cast<int>(count));
      tiles.assign(lights);
      draw(tiles);
      expect_in_place(tiles);
    }
  }
}

TEST(ShadowTiles, PagesThatServedOnceStay) {
  ShadowTiles tiles(256, true, kPageLimit);
  auto many = rows(6, 600);
  tiles.assign(many);
  const int pages = tiles.pages().count();
  const int side = tiles.pages().side();
  draw(tiles);
  for (unsigned frame = 0; frame < 8; ++frame) {
    auto lights = rows(frame, 30 + 70 * static_cast<int>(frame));
    tiles.assign(lights);
    draw(tiles);
    EXPECT_EQ(tiles.pages().count(), pages);
    EXPECT_EQ(tiles.pages().side(), side);
    expect_in_place(tiles);
  }
}

TEST(ShadowTiles, EqualMapsLargerThanAPageHaveNoTilesAndThoseByPowerShareIt) {
  constexpr int kSmallPage = 2048;  // what OpenGL ES 3.1 guarantees
  EXPECT_EQ(ShadowTiles(kSmallPage + 1, false, kSmallPage).capacity(), 0u);
  EXPECT_EQ(ShadowTiles(kSmallPage, false, kSmallPage).capacity(), static_cast<std::size_t>(kMostPages));
  ShadowTiles tiles(2 * kSmallPage, true, kSmallPage);
  ASSERT_GT(tiles.capacity(), 0u);
  auto lights = rows(8, static_cast<int>(tiles.capacity()));
  tiles.assign(lights);
  expect_in_place(tiles);
  EXPECT_LE(tiles.pages().side() * tiles.unit(), kSmallPage);
}

TEST(ShadowTiles, NoLightsHaveNoPlace) {
  ShadowTiles tiles(256, true, kPageLimit);
  auto lights = rows(7, 50);
  tiles.assign(lights);
  draw(tiles);
  tiles.assign({});
  EXPECT_TRUE(tiles.tiles().empty());
  tiles.assign(lights);
  EXPECT_EQ(stale(tiles), 50);
  expect_in_place(tiles);
}

}  // namespace
}  // namespace lightwell::render
