// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "render/caster_buffers.h"
#include "render/light_rows.h"
#include "render/tile_allocator.h"

namespace lightwell::render {

// Times map_size: the side of the strongest lights' maps.
inline constexpr int kLargestMap = 4;

struct ShadowAtlasOptions {
  int map_size = 256;  // texels a side of a light's map, on average
  bool texels_by_power =
      true;  // strong lights have larger maps, weak ones smaller, of as many texels together
};

// Shadow maps of many lights as tiles of one 16 bit depth texture. A map is drawn anew when its light came to another
// place by more than kMovedTexels, when a caster moved, or when its light is to have many more or fewer texels.
class ShadowAtlas {
 public:
  // Maps up to map_size show coarse meshes, larger ones (kLargestMap times map_size at the most) fine ones.
  static Result<ShadowAtlas> create(const Casters& coarse, const Casters& fine,
                                    const ShadowAtlasOptions& options);

  // True where some lights' maps are larger than map_size.
  static bool has_large_maps(const ShadowAtlasOptions& options);
  // Largest side of an atlas on this driver: 4096, which small boards have, or what the driver allows.
  static int side_limit();
  // Lights whose maps the atlas holds at once.
  [[nodiscard]] int capacity() const;
  [[nodiscard]] int map_size() const { return options_.map_size; }
  [[nodiscard]] GLuint texture() const { return texture_.id(); }
  [[nodiscard]] int side() const { return allocator_.side() * unit_; }  // texels
  [[nodiscard]] bool empty() const { return coarse_.empty(); }

  // Follows casters that moved; all maps are drawn anew.
  void move(const Casters& coarse, const Casters& fine);
  // Gives each row, at most capacity(), its map, and draws what is not there yet. The casters are those it was made of. A
  // light that moved so little that its map stands takes the map's direction.
  Status draw(std::span<LightRow> rows, const Casters& coarse, const Casters& fine);
  [[nodiscard]] int largest() const;  // side of the last draw()'s largest map, texels
  // Maps drawn by the last draw(), and their MapRows into the atlas's clip space: for what else is to stand in them.
  [[nodiscard]] std::size_t drawn() const { return drawn_; }
  [[nodiscard]] GLuint instances() const { return instances_.id(); }
  // Makes the whole atlas the place to draw to.
  void bind() const;

 private:
  struct Tile {
    LightRow row{};  // as it was drawn
    int side = 0;    // units
    int wished = 0;  // its share
    TileAllocator::Corner at{0, 0};
    bool stale = true;
  };

  [[nodiscard]] std::vector<int> sides_of(std::span<const LightRow> rows) const;  // units
  void match(std::span<const LightRow> rows, std::vector<Tile>& tiles);
  Status place(std::vector<Tile>& tiles);
  Status resize(int side_units);
  [[nodiscard]] bool is_large(const Tile& tile) const { return tile.side * unit_ > options_.map_size; }
  void draw_stale(const Casters& coarse, const Casters& fine);
  void clear(std::span<const Tile* const> tiles) const;
  void upload(std::span<const Tile* const> tiles, const Casters& casters);
  void draw_tiles(std::span<const Tile* const> tiles, std::size_t first, const CasterBuffers& buffers) const;

  ShadowAtlasOptions options_;
  int unit_ = 64;  // texels; tiles are unit · 2ᵏ
  TileAllocator allocator_;
  std::vector<Tile> tiles_;  // a row each
  std::size_t drawn_ = 0;
  CasterBuffers coarse_, fine_;
  gl::Program program_;
  gl::Buffer instances_;
  gl::Texture texture_;
  gl::Framebuffer framebuffer_;
};

// A light may come so far from where its map was drawn, at the edge of what casts, before it is drawn anew.
inline constexpr float kMovedTexels = 0.25f;

}  // namespace lightwell::render
