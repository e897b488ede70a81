// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lighting/decomposition/atoms.h"
#include "lighting/decomposition/error_kernel.h"

namespace lightwell {

// Values of the lights, a row a channel.
using ChannelRows = std::array<std::vector<double>, 3>;

// Where the lights of a decomposition stand: as vectors, as points of the kernels, as Lambertian moments, and who they
// are. A light that is set at a new place is another light and has another id. Allocates nothing after construction.
class PlacedLights {
 public:
  explicit PlacedLights(int count);

  [[nodiscard]] int count() const { return static_cast<int>(directions_.size()); }
  void set(int i, const Vec3d& direction) noexcept;
  [[nodiscard]] const std::vector<Vec3d>& directions() const { return directions_; }
  [[nodiscard]] const Vec3d& direction(int i) const { return directions_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] const MomentVector& moments(int i) const { return moments_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] std::uint32_t id(int i) const { return ids_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] placement_kernel::Points points() const;
  [[nodiscard]] int nearest_to(const Vec3d& direction) const noexcept;

  // What a distribution of light is worth at lights first … last − 1: to[c][i] = Σ weight · error_kernel. moments: the
  // distribution's.
  void potentials(const Atoms& of, const MomentMatrix& moments, int first, int last,
                  ChannelRows& to) const noexcept;

 private:
  std::vector<Vec3d> directions_;
  std::vector<MomentVector> moments_;
  std::vector<std::uint32_t> ids_;
  std::uint32_t next_id_ = 1;
  Atoms points_;
};

}  // namespace lightwell
