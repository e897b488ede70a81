// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/shadow_atlas.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "render/texel_shares.h"

namespace lightwell::render {
namespace {

// A map smaller than this would be border for the most part.
constexpr int kLeastMap = 64;

double luminance_of(const LightRow& row) {
  return 0.2126 * static_cast<double>(row.illuminance[0]) + 0.7152 * static_cast<double>(row.illuminance[1]) +
         0.0722 * static_cast<double>(row.illuminance[2]);
}

// What is seen of a light's shadow: on the ground, and a little on what stands upright.
double weight_of(const LightRow& row) {
  return luminance_of(row) * (0.2 + 0.8 * std::max(0.0, static_cast<double>(row.to_light[1])));
}

float distance(const LightRow& a, const LightRow& b) {
  float square = 0;
  for (int i = 0; i < 3; ++i) square += (a.to_light[i] - b.to_light[i]) * (a.to_light[i] - b.to_light[i]);
  return std::sqrt(square);
}

}  // namespace

int ShadowAtlas::side_limit() {
  GLint driver = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &driver);
  return std::min(4096, static_cast<int>(driver));
}

bool ShadowAtlas::has_large_maps(const ShadowAtlasOptions& options) {
  return options.texels_by_power && options.map_size >= kLeastMap;
}

Result<ShadowAtlas> ShadowAtlas::create(const Casters& coarse, const Casters& fine,
                                        const ShadowAtlasOptions& options) {
  ShadowAtlas atlas;
  atlas.options_ = options;
  atlas.unit_ = has_large_maps(options) ? std::max(options.map_size / 4, 1) : options.map_size;
  auto program = gl::make_program("shadow_vertex", "empty_fragment");
  if (!program) return program.error();
  atlas.program_ = std::move(program).value();
  atlas.coarse_ = CasterBuffers(coarse);
  atlas.fine_ = CasterBuffers(fine);
  atlas.instances_ =
      gl::make_buffer(GL_ARRAY_BUFFER, nullptr, kMaxLightsPerBlock * sizeof(MapRows), GL_STREAM_DRAW);
  if (Status s = atlas.resize(1); !s) return s.error();
  return atlas;
}

void ShadowAtlas::move(const Casters& coarse, const Casters& fine) {
  coarse_.move(coarse);
  fine_.move(fine);
  for (Tile& tile : tiles_) tile.stale = true;
}

int ShadowAtlas::capacity() const {
  const int side = side_limit() / options_.map_size;
  return std::min(kMaxLightsPerBlock, side * side);
}

Status ShadowAtlas::resize(int side_units) {
  texture_ = gl::make_texture(GL_DEPTH_COMPONENT16, side_units * unit_, side_units * unit_);
  auto framebuffer = gl::make_framebuffer({}, texture_.id());
  if (!framebuffer) return framebuffer.error();
  framebuffer_ = std::move(framebuffer).value();
  allocator_.reset(side_units);
  return {};
}

std::vector<int> ShadowAtlas::sides_of(std::span<const LightRow> rows) const {
  std::vector<double> weights;
  weights.reserve(rows.size());
  for (const LightRow& row : rows) weights.push_back(weight_of(row));
  const int average = options_.map_size / unit_;
  const int whole = side_limit() / unit_;
  const double units =
      std::min(static_cast<double>(rows.size()) * average * average, static_cast<double>(whole) * whole);
  const int largest = average == 1 ? 1
                                   : std::min(kLargestMap * average,
                                              static_cast<int>(std::bit_floor(static_cast<unsigned>(whole))));
  return share_texels(weights, 1, largest, units);
}

// A tile for each row: one that shows its light already, or a new one.
void ShadowAtlas::match(std::span<const LightRow> rows, std::vector<Tile>& tiles) {
  const std::vector<int> wished = sides_of(rows);
  std::vector<char> kept(tiles_.size(), 0);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Tile tile;
    tile.row = rows[i];
    tile.side = tile.wished = wished[i];
    std::size_t best = tiles_.size();
    float least = std::numeric_limits<float>::infinity();
    for (std::size_t k = 0; k < tiles_.size(); ++k) {
      const Tile& there = tiles_[k];
      if (kept[k] || there.stale || there.row.extent_m != rows[i].extent_m) continue;
      // Sides change by powers of two: one step is no reason to draw.
      if (there.side > 2 * wished[i] || 2 * there.side < wished[i]) continue;
      const float away = distance(there.row, rows[i]);
      // What lies at the edge of the sphere comes that far, times its radius.
      const float radius = std::abs(there.row.extent_m) / (2 * kDepthPadding);
      const float finest_m = there.row.texel / std::max(there.row.fit[0], there.row.fit[1]);
      if (away < least && away * radius <= kMovedTexels * finest_m) {
        least = away;
        best = k;
      }
    }
    if (best < tiles_.size()) {
      tile = tiles_[best];
      tile.wished = wished[i];
      kept[best] = 1;
    }
    tiles.push_back(tile);
  }
  for (std::size_t k = 0; k < tiles_.size(); ++k)
    if (!kept[k] && tiles_[k].side > 0) allocator_.give_back(tiles_[k].at, tiles_[k].side);
}

// Corners for the stale tiles; where they do not fit among the others, for all, in a larger atlas if need be.
Status ShadowAtlas::place(std::vector<Tile>& tiles) {
  std::vector<Tile*> order;
  for (Tile& tile : tiles) order.push_back(&tile);
  std::stable_sort(order.begin(), order.end(),
                   [](const Tile* a, const Tile* b) { return a->side > b->side; });
  const auto take = [&](Tile& tile) {
    const auto at = allocator_.take(tile.side);
    if (at) tile.at = *at;
    return at.has_value();
  };
  if (std::all_of(order.begin(), order.end(), [&](Tile* tile) { return !tile->stale || take(*tile); }))
    return {};
  const int limit = side_limit() / unit_;
  double units = 0;
  for (Tile& tile : tiles) {
    tile.stale = true;
    tile.side = tile.wished;
    units += static_cast<double>(tile.side) * tile.side;
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const Tile* a, const Tile* b) { return a->side > b->side; });
  const int step = std::max(options_.map_size / unit_, 1);
  int side = std::min(limit, (static_cast<int>(std::ceil(std::sqrt(units))) + step - 1) / step * step);
  side = std::max(side, allocator_.side());
  for (;; side = std::min(limit, side + step)) {
    if (side == allocator_.side()) {
      allocator_.reset(side);
    } else if (Status s = resize(side); !s) {
      return s;
    }
    if (std::all_of(order.begin(), order.end(), [&](Tile* tile) { return take(*tile); })) return {};
    if (side < limit) continue;
    // Shares may leave gaps where the atlas's side is no power of two; equal tiles always fit (capacity).
    for (Tile& tile : tiles) tile.side = std::min(tile.side, step);
    allocator_.reset(side);
    if (std::all_of(order.begin(), order.end(), [&](Tile* tile) { return take(*tile); })) return {};
    return Error{ErrorKind::failed, "the shadow maps do not fit their atlas"};
  }
}

int ShadowAtlas::largest() const {
  int side = 0;
  for (const Tile& tile : tiles_) side = std::max(side, tile.side * unit_);
  return side;
}

void ShadowAtlas::bind() const {
  const int side = allocator_.side() * unit_;
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  glViewport(0, 0, side, side);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
}

void ShadowAtlas::clear(std::span<const Tile* const> tiles) const {
  if (tiles.size() == tiles_.size()) {
    glClear(GL_DEPTH_BUFFER_BIT);
    return;
  }
  glEnable(GL_SCISSOR_TEST);
  for (const Tile* tile : tiles) {
    glScissor(tile->at.x * unit_, tile->at.y * unit_, tile->side * unit_, tile->side * unit_);
    glClear(GL_DEPTH_BUFFER_BIT);
  }
  glDisable(GL_SCISSOR_TEST);
}

void ShadowAtlas::upload(std::span<const Tile* const> tiles, const Casters& casters) {
  const auto whole = static_cast<float>(allocator_.side());
  std::vector<MapRows> instances;
  for (const Tile* tile : tiles) {
    MapRows rows = map_rows(tile->row, casters);
    const auto into_clip = [](float(&row)[4], float first, float size) {
      for (float& x : row) x *= 2 * size;
      row[3] += 2 * first - 1;
    };
    const float side = static_cast<float>(tile->side) / whole;
    into_clip(rows.u, static_cast<float>(tile->at.x) / whole, side);
    into_clip(rows.v, static_cast<float>(tile->at.y) / whole, side);
    into_clip(rows.w, 0, 1);
    instances.push_back(rows);
  }
  glBindBuffer(GL_ARRAY_BUFFER, instances_.id());
  glBufferData(GL_ARRAY_BUFFER, kMaxLightsPerBlock * sizeof(MapRows), nullptr, GL_STREAM_DRAW);
  glBufferSubData(GL_ARRAY_BUFFER, 0, static_cast<GLsizeiptr>(instances.size() * sizeof(MapRows)),
                  instances.data());
}

// first: of these tiles among the instances
void ShadowAtlas::draw_tiles(std::span<const Tile* const> tiles, std::size_t first,
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
    const Tile& tile = *tiles[i];
    if (tile.row.extent_m < 0) continue;
    glScissor(tile.at.x * unit_, tile.at.y * unit_, tile.side * unit_, tile.side * unit_);
    buffers.bind(instances_.id(), (first + i) * sizeof(MapRows));
    buffers.draw_supports();
  }
  glDisable(GL_SCISSOR_TEST);
}

void ShadowAtlas::draw_stale(const Casters& coarse, const Casters& fine) {
  std::vector<const Tile*> stale;
  for (Tile& tile : tiles_) {
    if (!tile.stale) continue;
    fit_map(tile.row, is_large(tile) ? fine : coarse, tile.side * unit_);
    stale.push_back(&tile);
  }
  drawn_ = stale.size();
  if (stale.empty()) return;
  const auto large = std::stable_partition(
      stale.begin(), stale.end(), [&](const Tile* tile) { return tile->side * unit_ <= options_.map_size; });
  const auto small_count = static_cast<std::size_t>(large - stale.begin());
  const std::span<const Tile* const> all(stale);
  upload(all, coarse);
  bind();
  clear(all);
  glUseProgram(program_.id());
  draw_tiles(all.first(small_count), 0, coarse_);
  draw_tiles(all.subspan(small_count), small_count, fine_);
}

Status ShadowAtlas::draw(std::span<LightRow> rows, const Casters& coarse, const Casters& fine) {
  std::vector<Tile> tiles;
  tiles.reserve(rows.size());
  match(rows, tiles);
  if (Status s = place(tiles); !s) {
    tiles_.clear();
    return s;
  }
  tiles_ = std::move(tiles);
  draw_stale(coarse, fine);
  const float whole = static_cast<float>(allocator_.side());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Tile& tile = tiles_[i];
    tile.stale = false;
    LightRow& row = rows[i];
    const LightRow shown = row;
    row = tile.row;
    std::copy_n(shown.illuminance, 3, row.illuminance);
    row.tile[0] = static_cast<float>(tile.at.x) / whole;
    row.tile[1] = static_cast<float>(tile.at.y) / whole;
    row.tile[2] = static_cast<float>(tile.side) / whole;
  }
  return {};
}

}  // namespace lightwell::render
