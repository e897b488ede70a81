// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "lighting/decomposition/placement_kernel/kernel.h"
#include "lighting/polar_map.h"

namespace lightwell {

using Directions = Eigen::Matrix<double, 3, Eigen::Dynamic>;  // one unit vector a column

// Weighted directions, coordinate by coordinate: what placing lights works on instead of the map's bins. Weights are
// shares of the luminance of the whole map's illuminance, whatever its range.
struct Atoms {
  std::vector<float> x, y, z;                // unit; luminance-weighted mean of what the atom stands for
  std::vector<float> ground;                 // ground_share(y)
  std::array<std::vector<float>, 3> weight;  // RGB
  std::vector<float> luminance;
  std::vector<float> solid_angle_sr;
  int count = 0;
  double scale = 0;  // luminance of the map's illuminance, lux; 0: the map is black, there are no atoms
  Rgbd total = Rgbd::Zero();  // the map's illuminance, lux

  explicit Atoms(int capacity = 0);
  [[nodiscard]] int capacity() const { return static_cast<int>(x.size()); }
  [[nodiscard]] int padded() const;  // the places behind the last atom up to here have weight 0
  [[nodiscard]] placement_kernel::Points points() const;
  [[nodiscard]] std::array<const float*, 3> weights() const;
  [[nodiscard]] Rgbd weight_of(int k) const;
  [[nodiscard]] Vec3d direction(int k) const;
  // count < capacity
  void add(const Vec3d& direction, const Rgbd& weight, double solid_angle_sr) noexcept;
  void finish() noexcept;  // after the last add
};

// Map to atoms, allocating nothing: blocks of 6° × 12°; those with much of the light are divided into 3° × 6°, and those
// that still have much into 1° × 1° (bins, where they are larger); near the poles blocks are wider in azimuth. Black
// blocks give no atom; values that are not finite and positive count as 0.
class AtomMaker {
 public:
  // frame: half of the atoms, for half of the time; on captured maps lights then err by 1 % more.
  enum class Detail { frame, map };
  // lights: as many as the atoms are to place; more of them resolve more
  AtomMaker(const PolarGrid& grid, int lights, Detail detail = Detail::map);
  [[nodiscard]] int capacity() const { return capacity_; }
  // atoms: of this capacity at the least
  void make(const PolarMap& map, Atoms& atoms) noexcept;

 private:
  struct Cell {
    double r, g, b, x, y, z;
  };
  struct Block {
    int ring0, ring1, sector0, sector1;
  };

  void sum_cells(const PolarMap& map) noexcept;
  void add_block(const Cell& cell, const Block& block, Atoms& atoms) const noexcept;
  void add_parts(const PolarMap& map, const Block& block, int kept_free, Atoms& atoms) const noexcept;
  [[nodiscard]] Cell sum_bins(const PolarMap& map, const Block& block) const noexcept;
  [[nodiscard]] double solid_angle(const Block& block) const noexcept;

  PolarGrid grid_;
  double coarse_share_, fine_share_;
  int capacity_;
  std::vector<int> rows_;     // ring edges of the cells' rows, an even number of rows
  std::vector<int> columns_;  // sector edges of the cells' columns
  std::vector<double> ring_sine_, ring_cosine_, bin_solid_angle_sr_;  // of the rings
  std::vector<float> sine_, cosine_;                                  // of the sectors' azimuths
  std::array<std::vector<float>, 5> sums_;                            // over a row's rings
  std::vector<Cell> cells_;                                           // [rows][columns]
};

// At most `count` atoms that stand for all of them: the brightest group is divided in two at its luminance's median,
// along the axis in which it is widest, until there are enough (a median cut of points). Order: by division.
Atoms merge_atoms(const Atoms& atoms, int count);

}  // namespace lightwell
