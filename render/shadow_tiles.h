// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "render/light_rows.h"
#include "render/tile_pages.h"

namespace lightwell::render {

// Times map_size: the side of the strongest lights' maps.
inline constexpr int kLargestMap = 4;

// A light may come so far from where its map was drawn, at the edge of what casts, before it is drawn anew; and so may what
// casts.
inline constexpr float kMovedTexels = 0.25f;

// Pages of maps: 4096² texels of 16 bits each are 32 MB. At 256² a light, 1024 lights take four.
inline constexpr int kMostPages = 8;

struct ShadowTile {
  LightRow row{};  // the light as its map was drawn
  int side = 0;    // units
  int wished = 0;  // its share of the texels
  TilePages::Place place;
  bool stale = true;      // to be drawn
  double drawn_at_m = 0;  // ShadowTiles' way of the casters, when it was drawn
};

// Which light's map is where: a square tile each on pages of texels, whose sides are a unit's times powers of two. A light
// keeps its tile from frame to frame while its map serves.
class ShadowTiles {
 public:
  // map_size: texels a side of a map, on average, while the pages hold so many; page_limit: of a page's side, texels;
  // by_power: strong lights have larger maps, weak ones smaller, of as many texels together.
  ShadowTiles(int map_size, bool by_power, int page_limit);
  ShadowTiles() = default;

  // Lights that have tiles at once. 0: maps of such a size that are all equal are larger than a page may be.
  [[nodiscard]] std::size_t capacity() const;
  [[nodiscard]] int unit() const { return unit_; }  // texels
  [[nodiscard]] const TilePages& pages() const { return pages_; }
  // One a row, in the rows' order. What is stale is to be drawn, and said not to be.
  [[nodiscard]] std::span<ShadowTile> tiles() { return tiles_; }
  [[nodiscard]] std::span<const ShadowTile> tiles() const { return tiles_; }

  // Of the texels that map_size asks for, in (0, 1]: a light's map changes its side only where it is off by more than twice.
  void set_share(double share) { share_ = share; }
  // Gives each of these rows, at most capacity(), its tile. Brings them into the order of their pages.
  void assign(std::span<LightRow> rows);
  // What casts moved, no vertex by more than so much: maps in which that adds up to kMovedTexels are stale.
  void casters_moved(float farthest_m);
  void set_drawn(ShadowTile& tile) const;
  // The most of all tiles.
  [[nodiscard]] float casters_off_texels() const;
  void clear();

 private:
  [[nodiscard]] std::vector<int> shares(std::span<const LightRow> rows) const;  // units a side
  [[nodiscard]] std::vector<ShadowTile> match(std::span<const LightRow> rows);
  void place(std::vector<ShadowTile>& tiles);
  void place_anew(std::vector<ShadowTile>& tiles);

  int map_size_ = 256;
  int unit_ = 64;
  int page_limit_ = 64;  // units
  double share_ = 1;
  double way_m_ = 0;  // of the casters, added up
  TilePages pages_;
  std::vector<ShadowTile> tiles_;
};

}  // namespace lightwell::render
