// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lighting/decomposition/error_kernel.h"

namespace lightwell {

// The matrix of the error's kernel between lights that stand still for many frames, its inverse, and the powers that the
// two give: argmin over w ≥ 0 of ½ wᵀGw − wᵀb. A light that moves changes both by its row and column alone, O(N²).
// After place nothing is allocated.
class LightPowers {
 public:
  // The last solution's lights without power: where the next one starts.
  struct Dark {
    std::vector<int> lights;
    std::vector<char> is_dark;
  };

  explicit LightPowers(int lights);
  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] int stride() const { return stride_; }  // of rows, a multiple of 4
  [[nodiscard]] Dark no_dark() const;

  // All lights anew.
  void place(std::span<const Vec3d> directions);
  // Light i comes to directions[i], the others are as they were. False: rounding has eaten the inverse, place them anew.
  [[nodiscard]] bool move(int i, std::span<const Vec3d> directions) noexcept;
  // b and w: stride() values, b[i] = Σ light · k(direction i, light's). w[i] ≥ 0; 0 behind the lights.
  void solve(std::span<const double> b, Dark& dark, std::span<double> w) noexcept;

  // G · w without the ridge: the lights' own part of b.
  void potential(std::span<const double> w, std::span<double> out) const noexcept;
  [[nodiscard]] const double* matrix() const { return matrix_.data(); }    // stride × stride
  [[nodiscard]] const double* inverse() const { return inverse_.data(); }  // stride × stride
  [[nodiscard]] double inverse_diagonal(int i) const { return inverse_[at(i, i)]; }
  void multiply_by_inverse(std::span<const double> b, std::span<double> out) const noexcept;

 private:
  [[nodiscard]] std::size_t at(int i, int j) const {
    return static_cast<std::size_t>(i) * static_cast<std::size_t>(stride_) + static_cast<std::size_t>(j);
  }
  void correct(std::span<const double> b, std::span<double> x, int without) noexcept;
  bool solve_for_multipliers(std::span<const double> y, const std::vector<int>& dark) noexcept;

  int size_, stride_;
  std::vector<double> matrix_, inverse_;  // [stride][stride], row by row
  std::vector<double> column_, work_, correction_, unconstrained_, small_, multiplier_;
};

}  // namespace lightwell
