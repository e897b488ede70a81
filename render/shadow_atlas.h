// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "render/caster_buffers.h"
#include "render/light_rows.h"
#include "render/shadow_tiles.h"

namespace lightwell::render {

struct ShadowAtlasOptions {
  int map_size = 256;  // texels a side of a light's map, on average
  bool texels_by_power =
      true;  // strong lights have larger maps, weak ones smaller, of as many texels together
};

// Shadow maps of many lights as tiles of 16 bit depth textures, the pages. A map is drawn anew when its light came to another
// place by more than kMovedTexels, when casters may have by as much, or when its light is to have many more or fewer texels.
class ShadowAtlas {
 public:
  // Maps up to map_size show coarse meshes, larger ones (kLargestMap times map_size at the most) fine ones.
  static Result<ShadowAtlas> create(const Casters& coarse, const Casters& fine,
                                    const ShadowAtlasOptions& options);

  // True where some lights' maps are larger than map_size.
  static bool has_large_maps(const ShadowAtlasOptions& options);
  // Largest side of a page on this driver: 4096, which small boards have, or what the driver allows.
  static int side_limit();
  // Lights whose maps are held at once.
  [[nodiscard]] std::size_t capacity() const { return tiles_.capacity(); }
  // 0 before anything was drawn.
  [[nodiscard]] GLuint texture(int page) const {
    return pages_.empty() ? 0 : pages_[static_cast<std::size_t>(page)].texture.id();
  }
  [[nodiscard]] int side() const { return tiles_.pages().side() * tiles_.unit(); }  // of every page, texels
  [[nodiscard]] bool empty() const { return coarse_.empty(); }
  // The casters that it draws.
  [[nodiscard]] const CasterBuffers& coarse() const { return coarse_; }
  [[nodiscard]] const CasterBuffers& fine() const { return fine_; }

  // Follows casters that moved by so much at most. Infinity: all maps are drawn anew, as where the spheres that they fit
  // changed.
  void follow(const Casters& coarse, const Casters& fine, float farthest_m);
  // Of the texels that map_size asks for, in (0, 1]; nothing where all maps are equal.
  void set_share(double share) { tiles_.set_share(share); }
  // Lights that stand together in the rows, their maps on one page, as many as a block of uniforms holds at most.
  struct Block {
    int page = 0;
    std::size_t first = 0;
    std::size_t count = 0;
  };
  // Gives each row, at most capacity(), its map, draws what is not there yet, and brings the rows into blocks. The casters
  // are those it was made of. A light that moved so little that its map stands takes the map's direction.
  Result<std::vector<Block>> draw(std::span<LightRow> rows, const Casters& coarse, const Casters& fine);
  [[nodiscard]] int largest() const;  // side of the last draw()'s largest map, texels
  // Of its texels: how far casters may be from where a map shows them.
  [[nodiscard]] float casters_off_texels() const { return tiles_.casters_off_texels(); }
  [[nodiscard]] std::size_t drawn() const { return drawn_; }  // maps, by the last draw()
  // Where the last draw() drew, and the maps' MapRows into the page's clip space: for what else is to stand in them.
  [[nodiscard]] std::span<const Block> drawn_on() const { return drawn_on_; }
  [[nodiscard]] GLuint instances() const { return instances_.id(); }
  // Makes the whole page the place to draw to.
  void bind(int page) const;

 private:
  struct Page {
    gl::Texture texture;
    gl::Framebuffer framebuffer;
  };

  Status make_pages();
  [[nodiscard]] bool is_large(const ShadowTile& tile) const {
    return tile.side * tiles_.unit() > options_.map_size;
  }
  void draw_stale(const Casters& coarse, const Casters& fine);
  void draw_page(std::span<const ShadowTile* const> stale, const Block& block);
  void clear(std::span<const ShadowTile* const> tiles) const;
  void scissor(const ShadowTile& tile) const;
  void upload(std::span<const ShadowTile* const> tiles, const Casters& casters);
  void draw_tiles(std::span<const ShadowTile* const> tiles, std::size_t first,
                  const CasterBuffers& buffers) const;
  [[nodiscard]] std::vector<Block> place_rows(std::span<LightRow> rows);

  ShadowAtlasOptions options_;
  ShadowTiles tiles_;
  std::vector<Page> pages_;
  int pages_side_ = 0;  // texels
  std::size_t drawn_ = 0;
  std::vector<Block> drawn_on_;
  CasterBuffers coarse_, fine_;
  gl::Program program_;
  gl::Buffer instances_;
};

}  // namespace lightwell::render
