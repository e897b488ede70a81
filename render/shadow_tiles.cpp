// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/shadow_tiles.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include "render/texel_shares.h"

namespace lightwell::render {
namespace {

// A map smaller than this would be border for the most part.
constexpr int kLeastMap = 64;
// map_size over the side of the weakest lights' maps.
constexpr int kSmallestMap = 4;
// A soft edge at a quarter of what casts, in texels of a map of 256, is so many times the light's radius.
constexpr double kEdgeTexels = 128;

// What is seen of a light's shadow: on the ground, and a little on what stands upright.
double weight_of(const LightRow& row) {
  const double soft = 1 + kEdgeTexels * static_cast<double>(row.spread);
  return luminance_of(row) * (0.2 + 0.8 * std::max(0.0, static_cast<double>(row.to_light[1]))) / soft;
}

float distance(const LightRow& a, const LightRow& b) {
  float square = 0;
  for (int i = 0; i < 3; ++i) square += (a.to_light[i] - b.to_light[i]) * (a.to_light[i] - b.to_light[i]);
  return std::sqrt(square);
}

// How far a light may come from where its map was drawn, on the unit sphere: what lies at the edge of the map's sphere
// moves that much, times its radius.
float reach_of(const LightRow& drawn) {
  const float radius = std::abs(drawn.extent_m) / (2 * kDepthPadding);
  return kMovedTexels * drawn.texel / std::max(drawn.fit[0], drawn.fit[1]) / radius;
}

// How far casters may be from where a map shows them, its texels.
double off_texels(const ShadowTile& tile, double way_m) {
  const LightRow& row = tile.row;
  return (way_m - tile.drawn_at_m) * static_cast<double>(std::max(row.fit[0], row.fit[1]) / row.texel);
}

// Tiles whose maps stand, to be found by their light's place.
class StandingMaps {
 public:
  explicit StandingMaps(std::span<const ShadowTile> tiles) : tiles_(tiles) {
    for (std::size_t k = 0; k < tiles.size(); ++k) {
      if (tiles[k].stale) continue;
      order_.push_back(k);
      reach_ = std::max(reach_, reach_of(tiles[k].row));
    }
    std::sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) { return x(a) < x(b); });
  }

  // The nearest that serves a light and is_free; else how many tiles there are.
  template <class IsFree>
  [[nodiscard]] std::size_t nearest(const LightRow& row, int wished, const IsFree& is_free) const {
    std::size_t best = tiles_.size();
    float least = std::numeric_limits<float>::infinity();
    const float from = row.to_light[0] - reach_;
    for (auto at = std::lower_bound(order_.begin(), order_.end(), from,
                                    [&](std::size_t k, float value) { return x(k) < value; });
         at != order_.end() && x(*at) <= row.to_light[0] + reach_; ++at) {
      const ShadowTile& there = tiles_[*at];
      if (!is_free(*at) || there.row.extent_m != row.extent_m) continue;
      // Sides change by powers of two: one step is no reason to draw.
      if (there.side > 2 * wished || 2 * there.side < wished) continue;
      const float away = distance(there.row, row);
      if (away >= least || away > reach_of(there.row)) continue;
      least = away;
      best = *at;
    }
    return best;
  }

 private:
  [[nodiscard]] float x(std::size_t k) const { return tiles_[k].row.to_light[0]; }

  std::span<const ShadowTile> tiles_;
  std::vector<std::size_t> order_;  // by x
  float reach_ = 0;                 // the farthest of all
};

}  // namespace

ShadowTiles::ShadowTiles(int map_size, bool by_power, int page_limit)
    : map_size_(map_size),
      unit_(by_power && map_size >= kLeastMap ? map_size / kSmallestMap : map_size),
      page_limit_(page_limit / unit_) {}

std::size_t ShadowTiles::capacity() const {
  return static_cast<std::size_t>(kMostPages) * static_cast<std::size_t>(page_limit_) *
         static_cast<std::size_t>(page_limit_);
}

void ShadowTiles::casters_moved(float farthest_m) {
  const bool all = !std::isfinite(farthest_m);
  if (!all) way_m_ += static_cast<double>(farthest_m);
  for (ShadowTile& tile : tiles_)
    if (all || off_texels(tile, way_m_) > static_cast<double>(kMovedTexels)) tile.stale = true;
}

void ShadowTiles::set_drawn(ShadowTile& tile) const {
  tile.stale = false;
  tile.drawn_at_m = way_m_;
}

float ShadowTiles::casters_off_texels() const {
  double most = 0;
  for (const ShadowTile& tile : tiles_)
    if (!tile.stale) most = std::max(most, off_texels(tile, way_m_));
  return static_cast<float>(most);
}

void ShadowTiles::clear() {
  tiles_.clear();
  pages_ = {};
}

std::vector<int> ShadowTiles::shares(std::span<const LightRow> rows) const {
  std::vector<double> weights;
  weights.reserve(rows.size());
  for (const LightRow& row : rows) weights.push_back(weight_of(row));
  const int average = map_size_ / unit_;
  const double units = std::min(share_ * static_cast<double>(rows.size()) * average * average,
                                static_cast<double>(capacity()));
  const int largest = average == 1
                          ? 1
                          : std::min(kLargestMap * average,
                                     static_cast<int>(std::bit_floor(static_cast<unsigned>(page_limit_))));
  return share_texels(weights, 1, largest, units);
}

// A tile for each row: one that shows its light already, or a new one.
std::vector<ShadowTile> ShadowTiles::match(std::span<const LightRow> rows) {
  const std::vector<int> wished = shares(rows);
  const StandingMaps standing(tiles_);
  std::vector<char> kept(tiles_.size(), 0);
  std::vector<ShadowTile> tiles(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ShadowTile& tile = tiles[i];
    const std::size_t k =
        standing.nearest(rows[i], wished[i], [&](std::size_t candidate) { return kept[candidate] == 0; });
    if (k < tiles_.size()) {
      tile = tiles_[k];
      kept[k] = 1;
    } else {
      tile.row = rows[i];
      tile.side = wished[i];
    }
    tile.wished = wished[i];
  }
  for (std::size_t k = 0; k < tiles_.size(); ++k)
    if (kept[k] == 0) pages_.give_back(tiles_[k].place, tiles_[k].side);
  return tiles;
}

// Places for the stale tiles; where they do not fit among the others, for all.
void ShadowTiles::place(std::vector<ShadowTile>& tiles) {
  std::vector<ShadowTile*> order;
  for (ShadowTile& tile : tiles)
    if (tile.stale) order.push_back(&tile);
  std::stable_sort(order.begin(), order.end(),
                   [](const ShadowTile* a, const ShadowTile* b) { return a->side > b->side; });
  const bool fit = std::all_of(order.begin(), order.end(), [&](ShadowTile* tile) {
    const auto place = pages_.take(tile->side);
    if (place) tile->place = *place;
    return place.has_value();
  });
  if (!fit) place_anew(tiles);
}

void ShadowTiles::place_anew(std::vector<ShadowTile>& tiles) {
  const auto attempt = [&](int most) {
    std::vector<int> sides;
    for (const ShadowTile& tile : tiles) sides.push_back(std::min(tile.wished, most));
    auto packing = pack(sides, pages_, kMostPages, page_limit_, std::max(map_size_ / unit_, 1));
    if (!packing) return false;
    pages_ = std::move(packing->pages);
    for (std::size_t i = 0; i < tiles.size(); ++i) {
      tiles[i].side = sides[i];
      tiles[i].place = packing->places[i];
      tiles[i].stale = true;
    }
    return true;
  };
  // Shares may leave gaps where the pages' side is no power of two: the largest give way. Units always fit (capacity).
  int most = kLargestMap * std::max(map_size_ / unit_, 1);
  while (!attempt(most) && most > 1) most /= 2;
}

void ShadowTiles::assign(std::span<LightRow> rows) {
  std::vector<ShadowTile> tiles = match(rows);
  place(tiles);
  std::vector<std::size_t> order(rows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return tiles[a].place.page < tiles[b].place.page; });
  const std::vector<LightRow> given(rows.begin(), rows.end());
  tiles_.clear();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i] = given[order[i]];
    tiles_.push_back(tiles[order[i]]);
  }
}

}  // namespace lightwell::render
