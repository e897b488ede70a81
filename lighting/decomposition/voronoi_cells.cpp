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
      reach_(bins.blocks.size(), std::numeric_limits<double>::infinity()) {}

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

std::span<const VoronoiCells::Change> VoronoiCells::add(const Vec3d& place) {
  changes_.clear();
  const auto index = static_cast<std::uint32_t>(places_.size());
  places_.push_back(place);
  for (std::size_t block = 0; block < bins_.blocks.size(); ++block) {
    if (!reached(block, place)) continue;
    const std::size_t before = changes_.size();
    for (std::size_t i = bins_.blocks[block].begin; i < bins_.blocks[block].end; ++i) {
      const double cosine = bins_.direction[i].dot(place);
      if (!(cosine > cosine_[i])) continue;
      changes_.push_back({static_cast<std::uint32_t>(i), cell_[i], index});
      cell_[i] = index;
      cosine_[i] = cosine;
    }
    if (changes_.size() > before) set_reach(block);
  }
  return changes_;
}

std::span<const VoronoiCells::Change> VoronoiCells::move(std::span<const Move> moves) {
  changes_.clear();
  moving_.resize(places_.size(), false);
  for (const Move& m : moves) moving_[m.place] = true;
  near_.resize(bins_.blocks.size());
  for (std::size_t block = 0; block < bins_.blocks.size(); ++block) {
    near_[block].clear();
    for (const Move& m : moves)
      if (reached(block, places_[m.place]) || reached(block, m.to)) near_[block].push_back(m.place);
  }
  for (const Move& m : moves) places_[m.place] = m.to;
  for (std::size_t block = 0; block < bins_.blocks.size(); ++block)
    if (!near_[block].empty()) search_again(block);
  for (const Move& m : moves) moving_[m.place] = false;
  return changes_;
}

void VoronoiCells::assign(std::span<const Vec3d> places) {
  places_.assign(places.begin(), places.end());
  changes_.clear();
  for (std::size_t block = 0; block < bins_.blocks.size(); ++block) search(block);
}

void VoronoiCells::search(std::size_t block) {
  find_candidates(block);
  for (std::size_t i = bins_.blocks[block].begin; i < bins_.blocks[block].end; ++i) search_all(i);
  set_reach(block);
}

// After moves: a bin whose own place stood still can only have come nearer to one that moved.
void VoronoiCells::search_again(std::size_t block) {
  bool candidates = false;
  for (std::size_t i = bins_.blocks[block].begin; i < bins_.blocks[block].end; ++i) {
    if (!moving_[cell_[i]]) {
      take_nearer(i, near_[block]);
      continue;
    }
    if (!candidates) find_candidates(block);
    candidates = true;
    search_all(i);
  }
  set_reach(block);
}

// The places that can be nearest to a bin of the block.
void VoronoiCells::find_candidates(std::size_t block) {
  const LitBins::Block& b = bins_.blocks[block];
  distance2_.resize(places_.size());
  double nearest2 = std::numeric_limits<double>::infinity();
  for (std::size_t p = 0; p < places_.size(); ++p) {
    distance2_[p] = (b.centre - places_[p]).squaredNorm();
    nearest2 = std::min(nearest2, distance2_[p]);
  }
  const double limit = std::sqrt(nearest2) + 2 * b.radius + kRounding;
  candidates_.clear();
  for (std::size_t p = 0; p < places_.size(); ++p)
    if (distance2_[p] <= limit * limit) candidates_.push_back(static_cast<std::uint32_t>(p));
}

void VoronoiCells::search_all(std::size_t bin) {
  const std::uint32_t before = cell_[bin];
  cell_[bin] = kNone;
  cosine_[bin] = -3;
  for (const std::uint32_t p : candidates_) {
    const double cosine = bins_.direction[bin].dot(places_[p]);
    if (!(cosine > cosine_[bin])) continue;
    cell_[bin] = p;
    cosine_[bin] = cosine;
  }
  if (cell_[bin] != before) changes_.push_back({static_cast<std::uint32_t>(bin), before, cell_[bin]});
}

void VoronoiCells::take_nearer(std::size_t bin, std::span<const std::uint32_t> places) {
  const std::uint32_t before = cell_[bin];
  for (const std::uint32_t p : places) {
    const double cosine = bins_.direction[bin].dot(places_[p]);
    // Of equally near ones the first, as in a search of all.
    if (!(cosine > cosine_[bin] || (cosine == cosine_[bin] && p < cell_[bin]))) continue;
    cell_[bin] = p;
    cosine_[bin] = cosine;
  }
  if (cell_[bin] != before) changes_.push_back({static_cast<std::uint32_t>(bin), before, cell_[bin]});
}

}  // namespace lightwell
