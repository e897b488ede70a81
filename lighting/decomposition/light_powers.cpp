// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/light_powers.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace lightwell {
namespace {

constexpr double kLeastPivot = 1e-9;  // below the ridge: what is left of a light that others stand for
constexpr int kMostRounds = 24;

}  // namespace

LightPowers::LightPowers(int lights) : size_(lights), stride_((lights + 3) / 4 * 4) {
  const auto n = static_cast<std::size_t>(stride_);
  matrix_.assign(n * n, 0);
  inverse_.assign(n * n, 0);
  small_.assign(n * n, 0);
  for (auto* v : {&column_, &work_, &correction_, &unconstrained_, &multiplier_}) v->assign(n, 0);
}

LightPowers::Dark LightPowers::no_dark() const {
  Dark dark;
  dark.lights.reserve(static_cast<std::size_t>(size_));
  dark.is_dark.assign(static_cast<std::size_t>(size_), 0);
  return dark;
}

void LightPowers::place(std::span<const Vec3d> directions) {
  Eigen::MatrixXd g(size_, size_);
  for (int i = 0; i < size_; ++i)
    for (int j = 0; j <= i; ++j)
      g(i, j) = g(j, i) =
          error_kernel(directions[static_cast<std::size_t>(i)], directions[static_cast<std::size_t>(j)]);
  g.diagonal().array() += kRidge;
  const Eigen::MatrixXd inverse = g.llt().solve(Eigen::MatrixXd::Identity(size_, size_));
  for (int i = 0; i < size_; ++i)
    for (int j = 0; j < size_; ++j) {
      matrix_[at(i, j)] = g(i, j);
      inverse_[at(i, j)] = (inverse(i, j) + inverse(j, i)) / 2;
    }
}

// x += X (b − G x), X the inverse as it is: x of G x = b with what rounding has done to X squared away.
void LightPowers::correct(std::span<const double> b, std::span<double> x, int without) noexcept {
  const auto& kernel = placement_kernel::kernels();
  kernel.multiply(matrix_.data(), size_, stride_, x.data(), work_.data());
  for (int j = 0; j < size_; ++j) {
    const auto k = static_cast<std::size_t>(j);
    work_[k] = b[k] - work_[k];
  }
  if (without >= 0) work_[static_cast<std::size_t>(without)] = 0;
  kernel.multiply(inverse_.data(), size_, stride_, work_.data(), correction_.data());
  for (int j = 0; j < size_; ++j) x[static_cast<std::size_t>(j)] += correction_[static_cast<std::size_t>(j)];
}

// Both updates start from a corrected vector: then errors that the rest of the inverse has are passed on as they are and
// do not grow, however often lights move.
bool LightPowers::move(int i, std::span<const Vec3d> directions) noexcept {
  const auto& kernel = placement_kernel::kernels();
  const auto own_place = static_cast<std::size_t>(i);
  // Out: the inverse without light i.
  std::copy_n(&inverse_[at(i, 0)], stride_, column_.data());
  std::fill(unconstrained_.begin(), unconstrained_.end(), 0.0);
  unconstrained_[own_place] = 1;
  correct(unconstrained_, column_, -1);
  for (int j = 0; j < size_; ++j)
    inverse_[at(i, j)] = inverse_[at(j, i)] = column_[static_cast<std::size_t>(j)];
  if (!(column_[own_place] > 0)) return false;
  kernel.add_outer(inverse_.data(), size_, stride_, -1 / column_[own_place], column_.data(), column_.data());
  for (int j = 0; j < size_; ++j) inverse_[at(i, j)] = inverse_[at(j, i)] = 0;
  // In: by its Schur complement.
  for (int j = 0; j < size_; ++j)
    column_[static_cast<std::size_t>(j)] =
        error_kernel(directions[own_place], directions[static_cast<std::size_t>(j)]);
  column_[own_place] += kRidge;
  for (int j = 0; j < size_; ++j)
    matrix_[at(i, j)] = matrix_[at(j, i)] = column_[static_cast<std::size_t>(j)];
  const double own = column_[own_place];
  column_[own_place] = 0;
  kernel.multiply(inverse_.data(), size_, stride_, column_.data(), unconstrained_.data());
  correct(column_, unconstrained_, i);
  double complement = own;
  for (int j = 0; j < size_; ++j)
    complement -= column_[static_cast<std::size_t>(j)] * unconstrained_[static_cast<std::size_t>(j)];
  if (!(complement > kLeastPivot)) return false;
  unconstrained_[own_place] = -1;
  kernel.add_outer(inverse_.data(), size_, stride_, 1 / complement, unconstrained_.data(),
                   unconstrained_.data());
  return true;
}

void LightPowers::multiply_by_inverse(std::span<const double> b, std::span<double> out) const noexcept {
  placement_kernel::kernels().multiply(inverse_.data(), size_, stride_, b.data(), out.data());
}

void LightPowers::potential(std::span<const double> w, std::span<double> out) const noexcept {
  placement_kernel::kernels().multiply(matrix_.data(), size_, stride_, w.data(), out.data());
  for (int i = 0; i < size_; ++i) out[static_cast<std::size_t>(i)] -= kRidge * w[static_cast<std::size_t>(i)];
}

// The inverse restricted to the dark lights, times what they would have had: the pull that keeps each at zero.
bool LightPowers::solve_for_multipliers(std::span<const double> y, const std::vector<int>& dark) noexcept {
  const int m = static_cast<int>(dark.size());
  const auto l = [&](int i, int j) -> double& {
    return small_[static_cast<std::size_t>(i) * static_cast<std::size_t>(stride_) +
                  static_cast<std::size_t>(j)];
  };
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j <= i; ++j) {
      double v = inverse_[at(dark[static_cast<std::size_t>(i)], dark[static_cast<std::size_t>(j)])];
      for (int k = 0; k < j; ++k) v -= l(i, k) * l(j, k);
      if (i == j) {
        if (!(v > 0)) return false;
        l(i, i) = std::sqrt(v);
      } else {
        l(i, j) = v / l(j, j);
      }
    }
  }
  for (int i = 0; i < m; ++i) {
    double v = -y[static_cast<std::size_t>(dark[static_cast<std::size_t>(i)])];
    for (int k = 0; k < i; ++k) v -= l(i, k) * multiplier_[static_cast<std::size_t>(k)];
    multiplier_[static_cast<std::size_t>(i)] = v / l(i, i);
  }
  for (int i = m; i-- > 0;) {
    double v = multiplier_[static_cast<std::size_t>(i)];
    for (int k = i + 1; k < m; ++k) v -= l(k, i) * multiplier_[static_cast<std::size_t>(k)];
    multiplier_[static_cast<std::size_t>(i)] = v / l(i, i);
  }
  return true;
}

// Block principal pivoting (Portugal, Júdice and Vicente 1994) on the inverse: with the lights of Z dark,
// w = y + G⁻¹(:, Z) μ, y = G⁻¹ b, G⁻¹(Z, Z) μ = −y(Z). All that violate w ≥ 0 or μ ≥ 0 change sides; only the last of
// them while their number does not fall.
void LightPowers::solve(std::span<const double> b, Dark& dark, std::span<double> w) noexcept {
  const auto& kernel = placement_kernel::kernels();
  kernel.multiply(inverse_.data(), size_, stride_, b.data(), unconstrained_.data());
  double largest = 0;
  for (int i = 0; i < size_; ++i)
    largest = std::max(largest, std::abs(unconstrained_[static_cast<std::size_t>(i)]));
  const double least = 1e-9 * largest;
  double largest_b = 0;
  for (int i = 0; i < size_; ++i) largest_b = std::max(largest_b, std::abs(b[static_cast<std::size_t>(i)]));
  const double pull = -1e-13 * largest_b;  // a dark light that is pulled up by less stays
  int fewest = size_ + 1, patience = 3;
  for (int round = 0; round < kMostRounds; ++round) {
    std::copy(unconstrained_.begin(), unconstrained_.end(), w.begin());
    if (!solve_for_multipliers(unconstrained_, dark.lights)) break;
    for (std::size_t z = 0; z < dark.lights.size(); ++z) {
      const double* row = &inverse_[at(dark.lights[z], 0)];
      for (int i = 0; i < size_; ++i) w[static_cast<std::size_t>(i)] += multiplier_[z] * row[i];
    }
    int violating = 0, last = -1;
    for (int i = 0; i < size_; ++i)
      if (dark.is_dark[static_cast<std::size_t>(i)] == 0 && w[static_cast<std::size_t>(i)] < -least)
        ++violating, last = i;
    for (std::size_t z = 0; z < dark.lights.size(); ++z)
      if (multiplier_[z] < pull) ++violating, last = std::max(last, dark.lights[z]);
    if (violating == 0) break;
    const bool all = violating < fewest || --patience >= 0;
    if (violating < fewest) {
      fewest = violating;
      patience = 3;
    }
    for (std::size_t z = 0; z < dark.lights.size(); ++z) {
      const int i = dark.lights[z];
      if (multiplier_[z] < pull && (all || i == last)) dark.is_dark[static_cast<std::size_t>(i)] = 2;
    }
    for (int i = 0; i < size_; ++i) {
      char& side = dark.is_dark[static_cast<std::size_t>(i)];
      if (side == 2)
        side = 0;
      else if (side == 0 && w[static_cast<std::size_t>(i)] < -least && (all || i == last))
        side = 1;
    }
    dark.lights.clear();
    for (int i = 0; i < size_; ++i)
      if (dark.is_dark[static_cast<std::size_t>(i)]) dark.lights.push_back(i);
    if (static_cast<int>(dark.lights.size()) == size_) {  // no light at all: start anew
      dark.lights.clear();
      std::fill(dark.is_dark.begin(), dark.is_dark.end(), char{0});
    }
  }
  for (int i = 0; i < size_; ++i) {
    double& v = w[static_cast<std::size_t>(i)];
    v = dark.is_dark[static_cast<std::size_t>(i)] || !(v > 0) ? 0 : v;
  }
  std::fill(w.begin() + size_, w.begin() + stride_, 0.0);
}

}  // namespace lightwell
