// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lighting/decomposition/lit_bins.h"
#include "lighting/decomposition/sphere_grid.h"
#include "lighting/vector.h"

namespace lightwell {

// Which of many places each lit bin is nearest to: the Voronoi cells of the places, on the bins' centres. Of
// equally near places the first one has the bin. Places may be added and moved; only blocks of bins that a
// change can reach are looked at again, and there only places that the block's middle and radius do not rule
// out (both by the triangle inequality, so the cells are exact).
class VoronoiCells {
 public:
  // bins must outlive the cells
  explicit VoronoiCells(const LitBins& bins);

  struct Change {
    std::uint32_t bin, from, to;  // bin: index in LitBins
  };
  struct Move {
    std::uint32_t place;
    Vec3d to;
  };
  static constexpr std::uint32_t kNone = 0xffffffff;  // cell of a bin while there is no place

  // unit directions. The changes stay valid until the next call.
  std::span<const Change> add(const Vec3d& place);
  std::span<const Change> move(std::span<const Move> moves);
  // These places instead of all before.
  void assign(std::span<const Vec3d> places);

  [[nodiscard]] const std::vector<Vec3d>& places() const { return places_; }
  [[nodiscard]] std::uint32_t cell(std::size_t bin) const { return cell_[bin]; }
  // Cosine of the angle to the nearest place; −3 while there is none.
  [[nodiscard]] double cosine(std::size_t bin) const { return cosine_[bin]; }
  // Blocks that may have a bin of this place's cell.
  [[nodiscard]] bool may_hold(std::size_t block, std::uint32_t place) const;

 private:
  void search_again(std::size_t block);
  void find_candidates(std::size_t block);
  void search_all(std::size_t bin);
  void take_nearer(std::size_t bin, std::span<const std::uint32_t> places);
  [[nodiscard]] bool reached(std::size_t block, const Vec3d& place) const;
  void set_reach(std::size_t block);
  // From the middle of any block to a place that one of its bins may be nearest to.
  [[nodiscard]] double largest_reach() const;

  const LitBins& bins_;
  SphereGrid blocks_;  // by their middles
  std::vector<Vec3d> places_;
  SphereGrid places_grid_;
  std::vector<std::uint32_t> cell_;  // [bins]
  std::vector<double> cosine_;       // [bins]
  std::vector<double> reach_;        // [blocks] largest distance (chord) of a bin to its place
  std::vector<Change> changes_;
  std::vector<std::uint32_t> candidates_;         // of a block
  std::vector<bool> moving_;                      // [places]
  std::vector<std::vector<std::uint32_t>> near_;  // [blocks] moving places that may matter there
  std::vector<std::uint32_t> touched_;            // blocks that have any
};

}  // namespace lightwell
