// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/fit/light_search.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace lightwell {
namespace {

constexpr int kDirections = 162;  // about 16° apart: a light's column is broader than that
constexpr int kDescent = 40;      // iterations; most need ten

// Even over the sphere: equal steps in height, azimuth by the golden angle.
Vec3d spread_direction(int i) {
  const double y = 1 - (2 * i + 1.0) / kDirections;
  const double lambda = kPi * (3 - std::sqrt(5.0)) * i;
  const double horizontal = std::sqrt(1 - y * y);
  return {horizontal * std::sin(lambda), y, horizontal * std::cos(lambda)};
}

// splitmix64 (Steele, Lea, Flood 2014): uniform in [0, 1).
double next_uniform(std::uint64_t& state) {
  state += 0x9e3779b97f4a7c15u;
  std::uint64_t z = state;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

}  // namespace

LightSearch::LightSearch(const FitObservations& observations, double enough)
    : observations_(observations),
      enough_(enough),
      solver_(observations),
      directions_(3, kDirections),
      columns_(observations.rows(), kDirections),
      residual_(observations.rows(), 3),
      values_(observations.rows(), kMostUnknowns) {
  for (int i = 0; i < kDirections; ++i) directions_.col(i) = spread_direction(i);
  columns_changed();
}

void LightSearch::columns_changed() noexcept {
  for (int i = 0; i < kDirections; ++i)
    observations_.light_column(directions_.col(i), columns_.col(i).data());
}

// The direction whose column, freed of what the lights there are could do, explains most of the residual.
Vec3d LightSearch::best_addition(const LightsTrial& trial) noexcept {
  solver_.residual(trial, residual_);
  observations_.ambient_column(values_.col(0).data());
  for (int k = 0; k < trial.count; ++k)
    observations_.light_column(trial.direction.col(k), values_.col(k + 1).data());
  const Eigen::Index n = trial.count + 1;
  SmallMatrix gram(n, n);
  for (Eigen::Index a = 0; a < n; ++a)
    for (Eigen::Index b = 0; b <= a; ++b)
      gram(a, b) = gram(b, a) = values_.col(a).dot(values_.col(b)) * (a == b ? 1 + 1e-9 : 1);
  const Eigen::LLT<SmallMatrix> factor(gram);
  double best = -1;
  Eigen::Index at = 0;
  for (Eigen::Index i = 0; i < kDirections; ++i) {
    double explained = 0;
    for (Eigen::Index c = 0; c < 3; ++c) {
      const double along = columns_.col(i).dot(residual_.col(c));
      if (along > 0) explained += along * along;
    }
    const double square = columns_.col(i).squaredNorm();
    if (explained <= best * 0.02 * square) continue;  // even alone it could not win
    SmallVector shared(n);
    for (Eigen::Index a = 0; a < n; ++a) shared[a] = values_.col(a).dot(columns_.col(i));
    factor.matrixL().solveInPlace(shared);
    const double own = std::max(square - shared.squaredNorm(), 0.02 * square);
    if (explained > best * own) {
      best = explained / own;
      at = i;
    }
  }
  return directions_.col(at);
}

LightsTrial LightSearch::with_one_more(const LightsTrial& trial) noexcept {
  LightsTrial more = trial;
  more.add(best_addition(trial));
  refine(more, kDescent);
  return more;
}

LightsTrial LightSearch::without(const LightsTrial& trial, int light) noexcept {
  LightsTrial fewer = trial;
  fewer.remove(light);
  fewer.positive = {};
  solver_.solve_powers(fewer);
  refine(fewer, kDescent);
  return fewer;
}

bool LightSearch::exchange_one(LightsTrial& trial, int light, double gain) noexcept {
  LightsTrial other = trial;
  other.remove(light);
  other.positive = {};
  solver_.solve_powers(other);
  other = with_one_more(other);
  if (!(other.cost < trial.cost * (1 - gain))) return false;
  const Vec3d found = other.direction.col(other.count - 1);
  for (int k = other.count - 1; k > light; --k) other.direction.col(k) = other.direction.col(k - 1);
  other.direction.col(light) = found;
  other.positive = {};
  solver_.solve_powers(other);
  trial = other;
  return true;
}

void LightSearch::exchange(LightsTrial& trial, int rounds, double gain) noexcept {
  int without_gain = 0;
  for (int i = 0; i < rounds * trial.count && without_gain < trial.count; ++i)
    without_gain = exchange_one(trial, i % trial.count, gain) ? 0 : without_gain + 1;
}

LightsTrial random_directions(int count, std::uint64_t& state) noexcept {
  LightsTrial trial;
  for (int k = 0; k < count; ++k) {
    const double y = 2 * next_uniform(state) - 1;
    const double lambda = 2 * kPi * next_uniform(state);
    const double horizontal = std::sqrt(1 - y * y);
    trial.add({horizontal * std::sin(lambda), y, horizontal * std::cos(lambda)});
  }
  return trial;
}

}  // namespace lightwell
