// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lighting/decomposition/atoms.h"
#include "lighting/decomposition/error_kernel.h"

namespace lightwell {

// Atoms with more than a hundredth of the map's light, in luminance or a channel, are summed in double: what a float's
// rounding takes from a sun of 99.99 % would be more than all the light beside it. While they are taken out, their
// weights in the atoms are 0. Allocates nothing after construction.
class BrightAtoms {
 public:
  struct Bright {
    Vec3d direction;
    Rgbd weight;
    int atom;
  };

  BrightAtoms();
  void take(Atoms& atoms) noexcept;
  void give_back(Atoms& atoms) const noexcept;
  [[nodiscard]] std::span<const Bright> all() const { return all_; }
  // Σ weight · error_kernel(at, atom)
  [[nodiscard]] Rgbd potential(const Vec3d& at) const noexcept;
  void add_moments(MomentMatrix& moments) const noexcept;

 private:
  std::vector<Bright> all_;
};

}  // namespace lightwell
