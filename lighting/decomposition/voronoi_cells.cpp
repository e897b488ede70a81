// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/voronoi_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lightwell {
namespace {

// Chords made of cosines carry √(2 · 1e-16).
constexpr double kRounding = 1e-7;

double chord(double cosine) {
  return std::sqrt(std::max(0.0, 2 - 2 * cosine));
}

}  // namespace

VoronoiCells::VoronoiCells(const LitBins& bins)
    : bins_(bins),
      cell_(bins.size(), kNone),
      cosine_(bins.size(), -3),
      reach_(bins.blocks.size(), std::numeric_limits<double>::infinity()),
      near_(bins.blocks.size()) {
  for (std::size_t block = 0; block < bins.blocks.size(); ++block)
    blocks_.add(static_cast<std::uint32_t>(block), bins.blocks[block].centre);
}

bool VoronoiCells::reached(std::size_t block, const Vec3d& place) const {
  const LitBins::Block& b = bins_.blocks[block];
  const double limit = reach_[block] + b.radius + kRounding;
  return (b.centre - place).squaredNorm() <= limit * limit;
}

bool VoronoiCells::may_hold(std::size_t block, std::uint32_t place) const {
  return reached(block, places_[place]);
}

void VoronoiCells::set_reach(std::size_t block) {
  double least = 1;
  for (std::size_t i = bins_.blocks[block].begin; i < bins_.blocks[block].end; ++i)
    least = std::min(least, cosine_[i]);
  reach_[block] = chord(least);
}

double VoronoiCells::largest_reach() const {
  double largest = 0;
  for (std::size_t block = 0; block < reach_.size(); ++block)
    largest = std::max(largest, reach_[block] + bins_.blocks[block].radius);
  return std::min(largest, 2.0) + kRounding;
}

std::span<const VoronoiCells::Change> VoronoiCells::add(const Vec3d& place) {
  changes_.clear();
  const auto index = static_cast<std::uint32_t>(places_.size());
  places_.push_back(place);
  places_grid_.add(index, place);
  blocks_.near(place, largest_reach(), [&](std::uint32_t block) {
    if (!reached(block, place)) return;
    const std::size_t before = changes_.size();
    for (std::size_t i = bins_.blocks[block].begin; i < bins_.blocks[block].end; ++i) {
      const double cosine = bins_.direction[i].dot(place);
      if (!(cosine > cosine_[i])) continue;
      changes_.push_back({static_cast<std::uint32_t>(i), cell_[i], index});
      cell_[i] = index;
      cosine_[i] = cosine;
    }
    if (changes_.size() > before) set_reach(block);
  });
  return changes_;
}

std::span<const VoronoiCells::Change> VoronoiCells::move(std::span<const Move> moves) {
  changes_.clear();
  touched_.clear();
  moving_.resize(places_.size(), false);
  const double reach = largest_reach();
  for (const Move& m : moves) {
    const Vec3d from = places_[m.place];
    blocks_.near(from, reach + (m.to - from).norm(), [&](std::uint32_t block) {
      if (!reached(block, from) && !reached(block, m.to)) return;
      if (near_[block].empty()) touched_.push_back(block);
      near_[block].push_back(m.place);
    });
  }
  for (const Move& m : moves) {
    moving_[m.place] = true;
    places_grid_.move(m.place, places_[m.place], m.to);
    places_[m.place] = m.to;
  }
  for (const std::uint32_t block : touched_) {
    search_again(block);
    near_[block].clear();
  }
  for (const Move& m : moves) moving_[m.place] = false;
  return changes_;
}

void VoronoiCells::assign(std::span<const Vec3d> places) {
  places_.assign(places.begin(), places.end());
  places_grid_ = SphereGrid();
  for (std::size_t p = 0; p < places_.size(); ++p)
    places_grid_.add(static_cast<std::uint32_t>(p), places_[p]);
  std::fill(cell_.begin(), cell_.end(), kNone);
  changes_.clear();
  for (std::size_t block = 0; block < bins_.blocks.size(); ++block) {
    find_candidates(block);
    for (std::size_t i = bins_.blocks[block].begin; i < bins_.blocks[block].end; ++i) search_all(i);
    set_reach(block);
  }
}

// After moves: a bin whose own place stood still can only have come nearer to one that moved.
void VoronoiCells::search_again(std::size_t block) {
  bool candidates = false;
  for (std::size_t i = bins_.blocks[block].begin; i < bins_.blocks[block].end; ++i) {
    const std::uint32_t before = cell_[i];
    if (!moving_[before]) {
      take_nearer(i, near_[block]);
      if (cell_[i] != before) changes_.push_back({static_cast<std::uint32_t>(i), before, cell_[i]});
      continue;
    }
    if (!candidates) find_candidates(block);
    candidates = true;
    search_all(i);
  }
  set_reach(block);
}

// The places that can be nearest to a bin of the block: as near to its middle as any place is known to be, and twice
// its radius more.
void VoronoiCells::find_candidates(std::size_t block) {
  const LitBins::Block& b = bins_.blocks[block];
  double nearest2 = std::numeric_limits<double>::infinity();
  std::uint32_t last = kNone;
  for (std::size_t i = b.begin; i < b.end; ++i) {
    if (cell_[i] == last) continue;
    last = cell_[i];
    if (last != kNone) nearest2 = std::min(nearest2, (b.centre - places_[last]).squaredNorm());
  }
  if (last == kNone)
    for (const Vec3d& place : places_) nearest2 = std::min(nearest2, (b.centre - place).squaredNorm());
  const double limit = std::sqrt(nearest2) + 2 * b.radius + kRounding;
  candidates_.clear();
  places_grid_.near(b.centre, limit, [&](std::uint32_t p) {
    if ((b.centre - places_[p]).squaredNorm() <= limit * limit) candidates_.push_back(p);
  });
}

void VoronoiCells::search_all(std::size_t bin) {
  const std::uint32_t before = cell_[bin];
  cell_[bin] = kNone;
  cosine_[bin] = -3;
  take_nearer(bin, candidates_);
  if (cell_[bin] != before) changes_.push_back({static_cast<std::uint32_t>(bin), before, cell_[bin]});
}

void VoronoiCells::take_nearer(std::size_t bin, std::span<const std::uint32_t> places) {
  for (const std::uint32_t p : places) {
    const double cosine = bins_.direction[bin].dot(places_[p]);
    // Of equally near ones the first.
    if (!(cosine > cosine_[bin] || (cosine == cosine_[bin] && p < cell_[bin]))) continue;
    cell_[bin] = p;
    cosine_[bin] = cosine;
  }
}

}  // namespace lightwell
