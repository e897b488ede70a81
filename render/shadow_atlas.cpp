// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/shadow_atlas.h"

#include <algorithm>
#include <string>
#include <tuple>

namespace lightwell::render {

int ShadowAtlas::side_limit() {
  GLint driver = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &driver);
  return std::min(4096, static_cast<int>(driver));
}

bool ShadowAtlas::has_large_maps(const ShadowAtlasOptions& options) {
  return ShadowTiles(options.map_size, options.texels_by_power, options.map_size).unit() < options.map_size;
}

Result<ShadowAtlas> ShadowAtlas::create(const Casters& coarse, const Casters& fine,
                                        const ShadowAtlasOptions& options) {
  ShadowAtlas atlas;
  atlas.options_ = options;
  atlas.tiles_ = ShadowTiles(options.map_size, options.texels_by_power, side_limit());
  if (atlas.tiles_.capacity() == 0)
    return Error{ErrorKind::usage, "shadow size " + std::to_string(options.map_size) +
                                       " is out of range: 1 to " + std::to_string(side_limit()) +
                                       " with this driver"};
  auto program = gl::make_program("shadow_vertex", "empty_fragment");
  if (!program) return program.error();
  atlas.program_ = std::move(program).value();
  atlas.coarse_ = CasterBuffers(coarse);
  atlas.fine_ = CasterBuffers(fine);
  atlas.instances_ = gl::make_buffer(GL_ARRAY_BUFFER, nullptr, sizeof(MapRows), GL_STREAM_DRAW);
  return atlas;
}

void ShadowAtlas::follow(const Casters& coarse, const Casters& fine, float farthest_m) {
  coarse_.move(coarse);
  fine_.move(fine);
  tiles_.casters_moved(farthest_m);
}

// The textures that the tiles' pages ask for, where they are not there. Pages grow together.
Status ShadowAtlas::make_pages() {
  if (pages_side_ != side()) pages_.clear();
  pages_side_ = side();
  while (pages_.size() < static_cast<std::size_t>(tiles_.pages().count())) {
    Page page;
    page.texture = gl::make_texture(GL_DEPTH_COMPONENT16, pages_side_, pages_side_);
    auto framebuffer = gl::make_framebuffer({}, page.texture.id());
    if (!framebuffer) return framebuffer.error();
    page.framebuffer = std::move(framebuffer).value();
    pages_.push_back(std::move(page));
  }
  return {};
}

int ShadowAtlas::largest() const {
  int side = 0;
  for (const ShadowTile& tile : tiles_.tiles()) side = std::max(side, tile.side * tiles_.unit());
  return side;
}

void ShadowAtlas::bind(int page) const {
  glBindFramebuffer(GL_FRAMEBUFFER, pages_[static_cast<std::size_t>(page)].framebuffer.id());
  glViewport(0, 0, pages_side_, pages_side_);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
}

void ShadowAtlas::scissor(const ShadowTile& tile) const {
  const int unit = tiles_.unit();
  glScissor(tile.place.at.x * unit, tile.place.at.y * unit, tile.side * unit, tile.side * unit);
}

// tiles: all that are stale of one page
void ShadowAtlas::clear(std::span<const ShadowTile* const> tiles) const {
  const auto on_page =
      std::count_if(tiles_.tiles().begin(), tiles_.tiles().end(),
                    [&](const ShadowTile& tile) { return tile.place.page == tiles.front()->place.page; });
  if (static_cast<std::ptrdiff_t>(tiles.size()) == on_page) {
    glClear(GL_DEPTH_BUFFER_BIT);
    return;
  }
  glEnable(GL_SCISSOR_TEST);
  for (const ShadowTile* tile : tiles) {
    scissor(*tile);
    glClear(GL_DEPTH_BUFFER_BIT);
  }
  glDisable(GL_SCISSOR_TEST);
}

void ShadowAtlas::upload(std::span<const ShadowTile* const> tiles, const Casters& casters) {
  const auto whole = static_cast<float>(tiles_.pages().side());
  std::vector<MapRows> instances;
  for (const ShadowTile* tile : tiles) {
    MapRows rows = map_rows(tile->row, casters);
    const auto into_clip = [](float(&row)[4], float first, float size) {
      for (float& x : row) x *= 2 * size;
      row[3] += 2 * first - 1;
    };
    const float side = static_cast<float>(tile->side) / whole;
    into_clip(rows.u, static_cast<float>(tile->place.at.x) / whole, side);
    into_clip(rows.v, static_cast<float>(tile->place.at.y) / whole, side);
    into_clip(rows.w, 0, 1);
    instances.push_back(rows);
  }
  glBindBuffer(GL_ARRAY_BUFFER, instances_.id());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(instances.size() * sizeof(MapRows)), instances.data(),
               GL_STREAM_DRAW);
}

// first: of these tiles among the instances
void ShadowAtlas::draw_tiles(std::span<const ShadowTile* const> tiles, std::size_t first,
                             const CasterBuffers& buffers) const {
  if (tiles.empty()) return;
  const GLint supports = gl::uniform(program_, "supports");
  glUniform1i(supports, 0);
  buffers.bind(instances_.id(), first * sizeof(MapRows));
  buffers.draw_objects(static_cast<GLsizei>(tiles.size()));
  if (!buffers.has_supports()) return;
  glUniform1i(supports, 1);
  glEnable(GL_SCISSOR_TEST);
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    if (tiles[i]->row.extent_m < 0) continue;
    scissor(*tiles[i]);
    buffers.bind(instances_.id(), (first + i) * sizeof(MapRows));
    buffers.draw_supports();
  }
  glDisable(GL_SCISSOR_TEST);
}

// Of a page small maps come first.
void ShadowAtlas::draw_page(std::span<const ShadowTile* const> stale, const Block& block) {
  const auto tiles = stale.subspan(block.first, block.count);
  bind(block.page);
  clear(tiles);
  glUseProgram(program_.id());
  const auto small = static_cast<std::size_t>(
      std::count_if(tiles.begin(), tiles.end(), [&](const ShadowTile* tile) { return !is_large(*tile); }));
  draw_tiles(tiles.first(small), block.first, coarse_);
  draw_tiles(tiles.subspan(small), block.first + small, fine_);
}

void ShadowAtlas::draw_stale(const Casters& coarse, const Casters& fine) {
  std::vector<const ShadowTile*> stale;
  for (ShadowTile& tile : tiles_.tiles()) {
    if (!tile.stale) continue;
    fit_map(tile.row, is_large(tile) ? fine : coarse, tile.side * tiles_.unit());
    tiles_.set_drawn(tile);
    stale.push_back(&tile);
  }
  drawn_ = stale.size();
  drawn_on_.clear();
  if (stale.empty()) return;
  std::stable_sort(stale.begin(), stale.end(), [&](const ShadowTile* a, const ShadowTile* b) {
    return std::tuple(a->place.page, is_large(*a)) < std::tuple(b->place.page, is_large(*b));
  });
  upload(stale, coarse);
  for (std::size_t i = 0; i < stale.size(); ++i) {
    if (drawn_on_.empty() || drawn_on_.back().page != stale[i]->place.page)
      drawn_on_.push_back({stale[i]->place.page, i, 0});
    ++drawn_on_.back().count;
  }
  for (const Block& block : drawn_on_) draw_page(stale, block);
}

std::vector<ShadowAtlas::Block> ShadowAtlas::place_rows(std::span<LightRow> rows) {
  std::vector<Block> blocks;
  const float whole = static_cast<float>(tiles_.pages().side());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ShadowTile& tile = tiles_.tiles()[i];
    LightRow& row = rows[i];
    const LightRow shown = row;
    row = tile.row;
    std::copy_n(shown.illuminance, 3, row.illuminance);
    row.spread = shown.spread;
    row.tile[0] = static_cast<float>(tile.place.at.x) / whole;
    row.tile[1] = static_cast<float>(tile.place.at.y) / whole;
    row.tile[2] = static_cast<float>(tile.side) / whole;
    if (blocks.empty() || blocks.back().page != tile.place.page || blocks.back().count == kMaxLightsPerBlock)
      blocks.push_back({tile.place.page, i, 0});
    ++blocks.back().count;
  }
  return blocks;
}

Result<std::vector<ShadowAtlas::Block>> ShadowAtlas::draw(std::span<LightRow> rows, const Casters& coarse,
                                                          const Casters& fine) {
  tiles_.assign(rows);
  if (Status s = make_pages(); !s) {
    tiles_.clear();
    pages_.clear();
    return s.error();
  }
  draw_stale(coarse, fine);
  return place_rows(rows);
}

}  // namespace lightwell::render
