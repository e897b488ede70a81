// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/fit/variable_projection.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace lightwell {
namespace {

constexpr double kMostStep = 0.5;  // rad: beyond it the linearisation says nothing

// out[j] = Σ_i a[i] columns[i + j rows]: four columns at a time, so that sums wait for no one and a is read once.
void inner_products(const double* a, const double* columns, Eigen::Index rows, Eigen::Index count,
                    double* out) {
  using Lanes = Eigen::Array<double, 4, 1>;
  const auto at = [](const double* p) { return Eigen::Map<const Lanes>(p); };
  Eigen::Index j = 0;
  for (; j + 3 < count; j += 4) {
    const double* b = columns + j * rows;
    Lanes s0 = Lanes::Zero(), s1 = s0, s2 = s0, s3 = s0;
    for (Eigen::Index i = 0; i < rows; i += 4) {
      const Lanes v = at(a + i);
      s0 += v * at(b + i);
      s1 += v * at(b + rows + i);
      s2 += v * at(b + 2 * rows + i);
      s3 += v * at(b + 3 * rows + i);
    }
    out[j] = s0.sum(), out[j + 1] = s1.sum(), out[j + 2] = s2.sum(), out[j + 3] = s3.sum();
  }
  for (; j < count; ++j) {
    const double* b = columns + j * rows;
    Lanes s0 = Lanes::Zero(), s1 = s0;
    Eigen::Index i = 0;
    for (; i + 4 < rows; i += 8) {
      s0 += at(a + i) * at(b + i);
      s1 += at(a + i + 4) * at(b + i + 4);
    }
    if (i < rows) s0 += at(a + i) * at(b + i);
    out[j] = (s0 + s1).sum();
  }
}

}  // namespace

Tangents tangents_of(const Vec3d& direction) {
  const Vec3d axis = std::abs(direction.y()) < 0.8 ? Vec3d::UnitY() : Vec3d::UnitX();
  const Vec3d t = axis.cross(direction).normalized();
  return {t, direction.cross(t)};
}

Vec3d moved(const Vec3d& direction, double along_t, double along_u) {
  const auto [t, u] = tangents_of(direction);
  return (direction + along_t * t + along_u * u).normalized();
}

VariableProjection::VariableProjection(const FitObservations& observations)
    : observations_(observations),
      values_(observations.rows(), kMostUnknowns),
      slopes_(observations.rows(), 2 * kMostFittedLights) {}

void VariableProjection::fill_values(const LightsTrial& trial) noexcept {
  observations_.ambient_column(values_.col(0).data());
  for (int k = 0; k < trial.count; ++k)
    observations_.light_column(trial.direction.col(k), values_.col(k + 1).data());
}

void VariableProjection::solve_powers(LightsTrial& trial) noexcept {
  fill_values(trial);
  const auto& observed = observations_.observed();
  const Eigen::Index n = trial.count + 1;
  gram_.resize(n, n);
  right_.resize(n, 3);
  const Eigen::Index rows = observations_.rows();
  std::array<double, kMostUnknowns> products;
  for (Eigen::Index a = 0; a < n; ++a) {
    inner_products(values_.col(a).data(), values_.data(), rows, a + 1, products.data());
    for (Eigen::Index b = 0; b <= a; ++b) gram_(a, b) = gram_(b, a) = products[static_cast<std::size_t>(b)];
    inner_products(values_.col(a).data(), observed.data(), rows, 3, products.data());
    for (Eigen::Index c = 0; c < 3; ++c) right_(a, c) = products[static_cast<std::size_t>(c)];
  }
  trial.cost = 0;
  for (Eigen::Index c = 0; c < 3; ++c) {
    auto& positive = trial.positive[static_cast<std::size_t>(c)];
    const NonnegativeSolution solution =
        solve_nonnegative(gram_, right_.col(c), positive & ((2u << trial.count) - 1));
    positive = solution.positive;
    trial.power.col(c).head(n) = solution.x.array();
    trial.cost += observed.col(c).squaredNorm() - 2 * solution.decrease;
  }
  trial.cost = std::max(trial.cost, 0.0);  // rounding of the difference
}

void VariableProjection::residual(const LightsTrial& trial,
                                  Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, 3>> out) noexcept {
  fill_values(trial);
  out = observations_.observed();
  for (Eigen::Index c = 0; c < 3; ++c)
    for (Eigen::Index a = 0; a <= trial.count; ++a) out.col(c) -= values_.col(a) * trial.power(a, c);
}

// With P the projection away from a channel's free columns V, x its powers and D the slopes: the residual P y has the
// derivative −P D x by Kaufman, so JᵀJ = Σ_c x x (DᵀD − DᵀV (VᵀV)⁻¹ VᵀD) and Jᵀr = −Σ_c x Dᵀ r, element by element.
void VariableProjection::derivatives(const LightsTrial& trial, Normal& normal, Gradient& gradient) noexcept {
  const Eigen::Index angles = 2 * trial.count;
  for (int k = 0; k < trial.count; ++k) {
    const Vec3d d = trial.direction.col(k);
    const auto [t, u] = tangents_of(d);
    observations_.slope_columns(d, t, u, slopes_.col(2 * k).data(), slopes_.col(2 * k + 1).data());
  }
  Normal slope_products(angles, angles);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMostUnknowns, 2 * kMostFittedLights>
      cross(trial.count + 1, angles);
  Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, 2 * kMostFittedLights> observed_slope(3,
                                                                                                     angles);
  const Eigen::Index rows = observations_.rows();
  for (Eigen::Index a = 0; a < angles; ++a) {
    const double* slope = slopes_.col(a).data();
    inner_products(slope, slopes_.data(), rows, a + 1, slope_products.col(a).data());
    inner_products(slope, values_.data(), rows, trial.count + 1, cross.col(a).data());
    inner_products(slope, observations_.observed().data(), rows, 3, observed_slope.col(a).data());
  }
  normal.setZero(angles, angles);
  gradient.setZero(angles);
  for (Eigen::Index c = 0; c < 3; ++c) {
    const unsigned positive = trial.positive[static_cast<std::size_t>(c)];
    if (positive >> 1 == 0) continue;  // no light in this channel
    std::array<Eigen::Index, kMostUnknowns> free{};
    Eigen::Index count = 0;
    for (Eigen::Index v = 0; v <= trial.count; ++v)
      if ((positive >> v & 1u) != 0) free[static_cast<std::size_t>(count++)] = v;
    SmallMatrix gram(count, count);
    decltype(cross) free_cross(count, angles);
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto row = free[static_cast<std::size_t>(i)];
      for (Eigen::Index j = 0; j < count; ++j) gram(i, j) = gram_(row, free[static_cast<std::size_t>(j)]);
      free_cross.row(i) = cross.row(row);
    }
    const Eigen::LLT<SmallMatrix> factor(gram);
    factor.matrixL().solveInPlace(free_cross);  // L⁻¹ VᵀD
    for (Eigen::Index a = 0; a < angles; ++a) {
      const double power_a = trial.power(a / 2 + 1, c);
      if (power_a == 0) continue;
      double slope_residual = observed_slope(c, a);
      for (Eigen::Index v = 0; v <= trial.count; ++v) slope_residual -= cross(v, a) * trial.power(v, c);
      gradient[a] -= power_a * slope_residual;
      for (Eigen::Index b = 0; b <= a; ++b) {
        const double projected = slope_products(b, a) - free_cross.col(a).dot(free_cross.col(b));
        normal(a, b) += power_a * trial.power(b / 2 + 1, c) * projected;
      }
    }
  }
  for (Eigen::Index a = 0; a < angles; ++a)
    for (Eigen::Index b = 0; b < a; ++b) normal(b, a) = normal(a, b);
}

int VariableProjection::refine(LightsTrial& trial, const Limits& limits) noexcept {
  if (trial.count == 0) return 0;
  Normal normal;
  Gradient gradient;
  LightsTrial next = trial;
  double damping = 1e-2;
  solve_powers(trial);
  derivatives(trial, normal, gradient);
  for (int iteration = 0; iteration < limits.iterations; ++iteration) {
    const double largest = normal.diagonal().maxCoeff();
    if (!(largest > 0)) return iteration;  // no light has power
    Normal damped = normal;
    // A light without power has no slope: it stays.
    for (Eigen::Index a = 0; a < damped.rows(); ++a)
      damped(a, a) += damping * std::max(normal(a, a), 1e-6 * largest);
    const Eigen::LLT<Normal> factor(damped);
    const Gradient step = -factor.solve(gradient);
    const double longest = step.cwiseAbs().maxCoeff();
    if (factor.info() != Eigen::Success || !std::isfinite(longest)) return iteration;
    const double shorter = longest > kMostStep ? kMostStep / longest : 1;
    next = trial;
    for (int k = 0; k < trial.count; ++k)
      next.direction.col(k) = moved(trial.direction.col(k), shorter * step[2 * k], shorter * step[2 * k + 1]);
    solve_powers(next);
    const double decrease = trial.cost - next.cost;
    if (decrease > 0) {
      trial = next;
      if (decrease <= limits.enough * trial.cost || trial.cost < 1e-16) return iteration + 1;
      damping = std::max(damping / 8, 1e-9);
      derivatives(trial, normal, gradient);
    } else {
      if (longest < 1e-7 || damping > 1e4) return iteration + 1;
      damping *= 6;
    }
  }
  return limits.iterations;
}

}  // namespace lightwell
