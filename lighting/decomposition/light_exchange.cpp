// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/light_exchange.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lightwell {
namespace {

constexpr double kLeastComplement = 1e-6;  // of a place where a light stands only the ridge is left

}  // namespace

LightExchange::LightExchange(int lights, int most_places)
    : size_(lights), stride_((lights + 3) / 4 * 4), most_places_(most_places) {
  const auto n = static_cast<std::size_t>(stride_);
  const auto m = static_cast<std::size_t>(most_places);
  inverse_.assign(n * n, 0);
  for (auto* v : {&worth_, &w_, &column_, &step_, &inverse_pivot_, &price_}) v->assign(n, 0);
  for (auto* v : {&kernel_, &by_inverse_}) v->assign(n * m, 0);
  for (auto* v : {&residual_, &complement_, &of_places_}) v->assign(m, 0);
  lit_.assign(n, 0);
  fresh_.assign(n, 0);
  taken_.assign(m, 0);
  pairs_.reserve(n);
}

double LightExchange::weigh(const LightPowers& powers, std::span<const double> w,
                            const LightPowers::Dark& dark) noexcept {
  const auto& kernel = placement_kernel::kernels();
  std::copy_n(powers.inverse(), inverse_.size(), inverse_.begin());
  std::fill(lit_.begin(), lit_.end(), char{0});
  std::fill_n(lit_.begin(), size_, char{1});
  for (const int z : dark.lights) {
    lit_[static_cast<std::size_t>(z)] = 0;
    double* row = &inverse_[static_cast<std::size_t>(z) * static_cast<std::size_t>(stride_)];
    std::copy_n(row, stride_, column_.begin());
    const double pivot = column_[static_cast<std::size_t>(z)];
    if (!(pivot > 0)) continue;
    kernel.add_outer(inverse_.data(), size_, stride_, -1 / pivot, column_.data(), column_.data());
    for (int j = 0; j < stride_; ++j) row[j] = 0;
    for (int j = 0; j < size_; ++j)
      inverse_[static_cast<std::size_t>(j) * static_cast<std::size_t>(stride_) +
               static_cast<std::size_t>(z)] = 0;
  }
  all_worth_ = 0;
  for (int i = 0; i < size_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double pivot = inverse_[k * static_cast<std::size_t>(stride_) + k];
    worth_[k] = lit_[k] && pivot > 0 ? w[k] * w[k] / pivot : 0;
    all_worth_ += worth_[k];
  }
  return all_worth_;
}

// Light i goes: powers, inverse and what depends on them follow.
void LightExchange::remove(int i) noexcept {
  const auto k = static_cast<std::size_t>(i);
  if (!lit_[k]) return;
  const auto& kernel = placement_kernel::kernels();
  double* row = &inverse_[k * static_cast<std::size_t>(stride_)];
  std::copy_n(row, stride_, column_.begin());
  const double pivot = column_[k];
  if (!(pivot > 0)) return;
  const double t = w_[k] / pivot;
  for (int j = 0; j < size_; ++j) w_[static_cast<std::size_t>(j)] -= column_[static_cast<std::size_t>(j)] * t;
  for (int c = 0; c < places_; ++c) {
    const auto p = static_cast<std::size_t>(c);
    of_places_[p] = by_inverse_[p * static_cast<std::size_t>(stride_) + k];
    residual_[p] += of_places_[p] * t;
    complement_[p] += of_places_[p] * of_places_[p] / pivot;
  }
  kernel.add_outer(inverse_.data(), size_, stride_, -1 / pivot, column_.data(), column_.data());
  kernel.add_outer(by_inverse_.data(), places_, stride_, -1 / pivot, of_places_.data(), column_.data());
  for (int j = 0; j < stride_; ++j) row[j] = 0;
  for (int j = 0; j < size_; ++j)
    inverse_[static_cast<std::size_t>(j) * static_cast<std::size_t>(stride_) + k] = 0;
  for (int c = 0; c < places_; ++c)
    by_inverse_[static_cast<std::size_t>(c) * static_cast<std::size_t>(stride_) + k] = 0;
  lit_[k] = 0;
  w_[k] = 0;
}

// Place c becomes light i, which is dark.
void LightExchange::insert(int c, int i, std::span<const Vec3d> places) noexcept {
  const auto& kernel = placement_kernel::kernels();
  const auto k = static_cast<std::size_t>(i);
  const auto chosen = static_cast<std::size_t>(c);
  std::copy_n(&by_inverse_[chosen * static_cast<std::size_t>(stride_)], stride_, column_.begin());
  const double s = complement_[chosen];
  const double power = std::max(residual_[chosen], 0.0) / s;
  const double* chosen_kernel = &kernel_[chosen * static_cast<std::size_t>(stride_)];
  kernel.multiply(by_inverse_.data(), places_, stride_, chosen_kernel, of_places_.data());
  for (int p = 0; p < places_; ++p) {
    const auto q = static_cast<std::size_t>(p);
    const double k_pc = error_kernel(places[q], places[chosen]);
    of_places_[q] = k_pc - of_places_[q];
    residual_[q] -= of_places_[q] * power;
    complement_[q] = std::max(complement_[q] - of_places_[q] * of_places_[q] / s, kLeastComplement);
    kernel_[q * static_cast<std::size_t>(stride_) + k] = k_pc;
  }
  for (int j = 0; j < size_; ++j)
    w_[static_cast<std::size_t>(j)] -= column_[static_cast<std::size_t>(j)] * power;
  w_[k] = power;
  column_[k] = -1;
  kernel.add_outer(inverse_.data(), size_, stride_, 1 / s, column_.data(), column_.data());
  kernel.add_outer(by_inverse_.data(), places_, stride_, -1 / s, of_places_.data(), column_.data());
  lit_[k] = 1;
  fresh_[k] = 1;
}

// Lights that just came stay: nothing pays their price.
void LightExchange::price_lights(double hysteresis) noexcept {
  for (int i = 0; i < stride_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double pivot = inverse_[k * static_cast<std::size_t>(stride_) + k];
    const bool lit = lit_[k] && pivot > 0;
    step_[k] = lit ? w_[k] / pivot : 0;
    inverse_pivot_[k] = lit ? 1 / pivot : 0;
    const bool stays = i >= size_ || fresh_[k] || (lit_[k] && !lit);
    price_[k] = stays ? std::numeric_limits<double>::infinity()
                : lit ? (1 + hysteresis) * w_[k] * step_[k]
                      : 0;
  }
}

std::span<const LightExchange::Pair> LightExchange::choose(std::span<const Vec3d> lights,
                                                           std::span<const double> w,
                                                           std::span<const Vec3d> places,
                                                           std::span<const double> rest,
                                                           const Options& options) noexcept {
  const auto& kernel = placement_kernel::kernels();
  const auto stride = static_cast<std::size_t>(stride_);
  places_ = std::min(static_cast<int>(places.size()), most_places_);
  pairs_.clear();
  std::copy_n(w.begin(), size_, w_.begin());
  std::fill(fresh_.begin(), fresh_.end(), char{0});
  std::fill(taken_.begin(), taken_.end(), char{0});
  for (int c = 0; c < places_; ++c)
    for (int i = 0; i < size_; ++i)
      kernel_[static_cast<std::size_t>(c) * stride + static_cast<std::size_t>(i)] =
          error_kernel(places[static_cast<std::size_t>(c)], lights[static_cast<std::size_t>(i)]);
  kernel.multiply_rows(kernel_.data(), places_, inverse_.data(), stride_, by_inverse_.data());
  for (int c = 0; c < places_; ++c) {
    const auto p = static_cast<std::size_t>(c);
    const double* row = &kernel_[p * stride];
    const double* inverse_row = &by_inverse_[p * stride];
    double r = rest[p];
    double s = error_kernel(places[p], places[p]) + kRidge;
    for (int i = 0; i < size_; ++i) {
      r -= row[i] * w_[static_cast<std::size_t>(i)];
      s -= row[i] * inverse_row[i];
    }
    residual_[p] = r;
    complement_[p] = std::max(s, kLeastComplement);
  }
  const double least = options.threshold * all_worth_ + 1e-14;
  while (static_cast<int>(pairs_.size()) < options.most) {
    price_lights(options.hysteresis);
    double best = least;
    Pair pair{-1, -1};
    for (int c = 0; c < places_; ++c) {
      const auto p = static_cast<std::size_t>(c);
      if (taken_[p]) continue;
      const int i = kernel.best_to_leave(&by_inverse_[p * stride], step_.data(), inverse_pivot_.data(),
                                         price_.data(), stride_, residual_[p], complement_[p], &best);
      if (i >= 0) pair = {i, c};
    }
    if (pair.light < 0) break;
    remove(pair.light);
    insert(pair.place, pair.light, places);
    taken_[static_cast<std::size_t>(pair.place)] = 1;
    const Vec3d& at = places[static_cast<std::size_t>(pair.place)];
    for (int c = 0; c < places_; ++c)
      if ((places[static_cast<std::size_t>(c)] - at).norm() < options.least_distance)
        taken_[static_cast<std::size_t>(c)] = 1;
    pairs_.push_back(pair);
    // A light whose power went below zero has left as well.
    for (int j = 0; j < size_; ++j)
      if (lit_[static_cast<std::size_t>(j)] && w_[static_cast<std::size_t>(j)] < 0) remove(j);
  }
  return pairs_;
}

}  // namespace lightwell
